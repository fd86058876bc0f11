//! Assigns photons to batches, and parts of batches to threads.

use etendue_scene::RunSettings;
use std::ops::Range;

/// The number of photons traced between two progress reports.
pub(crate) const BLOCK: usize = 4096;
/// A part of a batch holds fewer than 2 · `PART` photons, which take one thread about a second. A
/// run can stop only between parts. Summing up a part takes a few milliseconds.
const PART: u64 = 1 << 20;

/// A division of the photons of a run into batches of nearly equal size. Photons stay in the order
/// of their numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BatchRanges {
    photons: u64,
    batches: u32,
}

impl BatchRanges {
    pub(crate) fn new(run: &RunSettings) -> Self {
        Self {
            photons: run.photons,
            batches: run.batches,
        }
    }

    /// The range of the photons of a batch.
    pub(crate) fn of(&self, batch: u32) -> Range<u64> {
        let start = |b: u32| {
            let share = u128::from(self.photons) * u128::from(b) / u128::from(self.batches);
            u64::try_from(share).unwrap_or(u64::MAX)
        };
        start(batch)..start(batch + 1)
    }

    /// The number of parts of a batch. A batch has at least one part, and only an empty
    /// batch has an empty part.
    pub(crate) fn parts(&self, batch: u32) -> u32 {
        let parts = self.count(batch).div_ceil(self.part_length(batch));
        u32::try_from(parts).unwrap_or(u32::MAX).max(1)
    }

    /// The range of the photons of a part of a batch. Every block of the part except the
    /// last is full.
    pub(crate) fn part(&self, batch: u32, part: u32) -> Range<u64> {
        let range = self.of(batch);
        let length = u128::from(self.part_length(batch));
        let start = |part: u32| {
            let start = u128::from(range.start) + length * u128::from(part);
            u64::try_from(start).map_or(range.end, |start| start.min(range.end))
        };
        start(part)..start(part.saturating_add(1))
    }

    /// The number of photons in each part of a batch except the last part. The parts are
    /// long enough that their numbers fit in 32 bits.
    fn part_length(&self, batch: u32) -> u64 {
        let count = self.count(batch);
        let parts = count / PART.max(count >> 31);
        count
            .div_ceil(parts.max(1))
            .max(1)
            .next_multiple_of(BLOCK as u64)
    }

    /// The number of photons of a batch.
    pub(crate) fn count(&self, batch: u32) -> u64 {
        let range = self.of(batch);
        range.end - range.start
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two(photons: u64) -> BatchRanges {
        BatchRanges {
            photons,
            batches: 2,
        }
    }

    #[test]
    fn parts_make_the_batch() {
        for photons in [1, 5_000, 3 << 20, (3 << 20) + 77, 1_000_000_000_007] {
            let shares = two(photons);
            let parts = shares.parts(1);
            let mut next = shares.of(1).start;
            for part in (0..parts).map(|part| shares.part(1, part)) {
                assert_eq!(part.start, next);
                assert!(parts == 1 || !part.is_empty());
                next = part.end;
            }
            assert_eq!(next, shares.of(1).end);
        }
        assert_eq!(two(0).parts(0), 1);
        assert!(two(0).part(0, 0).is_empty());
    }

    #[test]
    fn parts_are_bounded() {
        for exponent in 21..52 {
            let shares = two((1 << exponent) + 12_345);
            let last = shares.parts(1) - 1;
            for part in [0, last / 2, last] {
                let part = shares.part(1, part);
                assert!(part.end - part.start < 2 * PART, "2^{exponent}: {part:?}");
            }
        }
        // Even the largest possible number of photons is divided into parts whose numbers fit in
        // 32 bits.
        let most = two(u64::MAX);
        let last = most.parts(1) - 1;
        assert_eq!(most.part(1, last).end, u64::MAX);
        assert!(!most.part(1, last).is_empty());
    }
}
