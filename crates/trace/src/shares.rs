use etendue_scene::Run;
use std::ops::Range;

/// Photons traced between two reports.
pub(crate) const BLOCK: usize = 4096;
/// Fewest photons of a part: what is summed up for each takes a few milliseconds.
const PART: u64 = 1 << 20;
/// Most parts of a batch: their sums wait for each other.
const MOST: u32 = 16;

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

    /// Parts of a batch for threads that have no batch of their own.
    pub(crate) fn parts(&self, batch: u32) -> u32 {
        u32::try_from(self.count(batch) / PART).map_or(MOST, |parts| parts.clamp(1, MOST))
    }

    /// The photons of a part, whole blocks of them but for the last.
    pub(crate) fn part(&self, batch: u32, part: u32) -> Range<u64> {
        let range = self.of(batch);
        let each = self.count(batch).div_ceil(u64::from(self.parts(batch)));
        let each = each.next_multiple_of(BLOCK as u64);
        let start = |part: u32| range.end.min(range.start + each * u64::from(part));
        start(part)..start(part + 1)
    }

    /// Their number.
    pub(crate) fn count(&self, batch: u32) -> u64 {
        let range = self.of(batch);
        range.end - range.start
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_make_the_batch() {
        for photons in [1, 5_000, 3 << 20, (3 << 20) + 77, 1_000_000_000_007] {
            let shares = Shares {
                photons,
                batches: 2,
            };
            let parts = shares.parts(1);
            let mut next = shares.of(1).start;
            for part in (0..parts).map(|part| shares.part(1, part)) {
                assert_eq!(part.start, next);
                assert!(parts == 1 || !part.is_empty());
                next = part.end;
            }
            assert_eq!(next, shares.of(1).end);
        }
        let parts = |photons| {
            Shares {
                photons,
                batches: 1,
            }
            .parts(0)
        };
        assert_eq!([1, 1 << 20, 5 << 20, 1 << 40].map(parts), [1, 1, 5, MOST]);
    }
}
