//! Emits the photons of two scenes in pairs.

use etendue_field::{Crossing, Ledger, PhotonSource};
use etendue_scene::Scene;
use etendue_trace::{AllLights, Tracer};

/// The photons of two scenes in pairs. The planes of the first scene come before those of the
/// second.
pub(crate) struct TwinPhotons {
    sources: [Box<dyn PhotonSource>; 2],
    /// Number of planes of each scene.
    planes: usize,
}

impl TwinPhotons {
    pub(crate) fn new(own: &Scene, other: &Scene) -> Self {
        fn boxed<S: PhotonSource + 'static>([other, own]: [S; 2]) -> [Box<dyn PhotonSource>; 2] {
            [Box::new(own), Box::new(other)]
        }
        let scenes = [other, own];
        let sources = match scenes.map(|scene| scene.other_lights.len()) {
            [0, 0] => boxed(Tracer::pair(scenes)),
            [a, b] if a == b => boxed(AllLights::pair(scenes)),
            _ => boxed(scenes.map(AllLights::photons)),
        };
        Self {
            sources,
            planes: own.planes.len(),
        }
    }
}

impl PhotonSource for TwinPhotons {
    fn emitted(&self, batch: u32) -> u64 {
        self.sources[0].emitted(batch)
    }

    fn is_precise(&self) -> bool {
        self.sources.iter().any(|source| source.is_precise())
    }

    fn parts(&self, batch: u32) -> u32 {
        let parts = self.sources.iter().map(|source| source.parts(batch));
        parts.max().unwrap_or(1)
    }

    /// The ledger and the progress are those of the first scene.
    fn emit_part(
        &self,
        batch: u32,
        part: u32,
        record: &mut dyn FnMut(usize, &[Crossing]),
        progress: &dyn Fn(u64),
    ) -> Ledger {
        let [own, other] = &self.sources;
        if part < other.parts(batch) {
            let planes = self.planes;
            let mut record = |plane: usize, of: &[Crossing]| record(planes + plane, of);
            other.emit_part(batch, part, &mut record, &|_| ());
        }
        match part < own.parts(batch) {
            true => own.emit_part(batch, part, record, progress),
            false => Ledger::default(),
        }
    }
}
