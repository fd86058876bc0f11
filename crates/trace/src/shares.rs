use etendue_scene::Run;
use std::ops::Range;

/// How the photons of a run are shared out: evenly over batches, in order.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shares {
    photons: u64,
    batches: u32,
}

impl Shares {
    pub(crate) fn new(run: &Run) -> Self {
        Self {
            photons: run.photons,
            batches: run.batches,
        }
    }

    /// The photons of a batch.
    pub(crate) fn of(&self, batch: u32) -> Range<u64> {
        let start = |b: u32| {
            let share = u128::from(self.photons) * u128::from(b) / u128::from(self.batches);
            u64::try_from(share).unwrap_or(u64::MAX)
        };
        start(batch)..start(batch + 1)
    }

    /// Their number.
    pub(crate) fn count(&self, batch: u32) -> u64 {
        let range = self.of(batch);
        range.end - range.start
    }
}
