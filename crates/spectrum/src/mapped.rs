//! Photons whose crossings are replaced before they are recorded.

use etendue_field::{Crossing, Ledger, PhotonSource};

struct MappedPhotons<'a, F> {
    source: Box<dyn PhotonSource + 'a>,
    map: F,
}

/// Photons whose crossings are replaced by a function of each of them. Blocks, parts and
/// the ledger are those of the original source.
#[must_use]
pub fn mapped_photons<'a>(
    source: Box<dyn PhotonSource + 'a>,
    map: impl Fn(&Crossing) -> Crossing + Sync + 'a,
) -> Box<dyn PhotonSource + 'a> {
    Box::new(MappedPhotons { source, map })
}

impl<F: Fn(&Crossing) -> Crossing + Sync> PhotonSource for MappedPhotons<'_, F> {
    fn emitted(&self, batch: u32) -> u64 {
        self.source.emitted(batch)
    }

    fn is_precise(&self) -> bool {
        self.source.is_precise()
    }

    fn parts(&self, batch: u32) -> u32 {
        self.source.parts(batch)
    }

    fn emit_part(
        &self,
        batch: u32,
        part: u32,
        record: &mut dyn FnMut(usize, &[Crossing]),
        progress: &dyn Fn(u64),
    ) -> Ledger {
        let mut mapped = Vec::new();
        let record = &mut |plane: usize, crossings: &[Crossing]| {
            mapped.clear();
            mapped.extend(crossings.iter().map(&self.map));
            record(plane, &mapped);
        };
        self.source.emit_part(batch, part, record, progress)
    }
}
