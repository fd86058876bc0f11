//! Random choices that define one case of an attack, or one random scene. Each random choice is a
//! function of the seed, the number of the case, and the number of previous choices.

use etendue_transform::random::{self, Stream};

/// The random numbers for one case.
#[derive(Debug)]
pub(crate) struct Dice {
    stream: Stream,
    seed: u64,
    case: u64,
    block: u32,
}

impl Dice {
    pub(crate) fn new(seed: u64, case: u64) -> Self {
        Self::of(Stream::Photon, seed, case)
    }

    /// Creates random choices from a stream of numbers.
    pub(crate) fn of(stream: Stream, seed: u64, case: u64) -> Self {
        Self {
            stream,
            seed,
            case,
            block: 0,
        }
    }

    fn words(&mut self) -> [u32; 4] {
        self.block += 1;
        random::words(self.seed, self.stream, self.case, self.block)
    }

    /// A number in 0..`n`, or 0 if `n` is 0.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        random::index(self.words()[0], n.max(1))
    }

    /// Returns true with probability 1/`n`.
    pub(crate) fn one_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }

    /// A random element of a list, which must not be empty.
    pub(crate) fn pick<'a, T>(&mut self, all: &'a [T]) -> &'a T {
        &all[self.below(all.len())]
    }

    /// A random length up to `most`. All orders of magnitude of the length are about
    /// equally likely.
    pub(crate) fn length(&mut self, most: usize) -> usize {
        let doublings = usize::BITS - most.leading_zeros();
        let reach = 1_usize << self.below(doublings as usize + 1).min(62);
        1 + self.below(reach.min(most))
    }

    /// A random byte.
    pub(crate) fn byte(&mut self) -> u8 {
        self.words()[0].to_le_bytes()[0]
    }

    /// A random number in (0, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        random::unit(self.words()[0])
    }

    /// A random number between two bounds.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
}
