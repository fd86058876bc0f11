//! The random numbers of a path.

use etendue_transform::Net;
use etendue_transform::random::{Stream, unit, words};

/// The sequence of random numbers of one path, in (0, 1).
#[derive(Debug)]
pub(crate) struct PathNumbers<'a> {
    seed: u64,
    path: u64,
    /// The pair of blocks from which numbers are taken, of four numbers each. Blocks are computed
    /// in pairs because a processor computes two at the same time.
    left: [u32; 8],
    used: usize,
    /// The index of the next block.
    block: u32,
    /// The net that gives the first numbers, and the index of its point that this path uses; `None`
    /// if no net is used.
    net: Option<(&'a Net, u32)>,
}

/// Number of blocks of four numbers in a net.
pub(crate) const JOINT: u32 = 2;

impl<'a> PathNumbers<'a> {
    pub(crate) fn new(seed: u64, path: u64) -> Self {
        Self {
            seed,
            path,
            left: [0; 8],
            used: 8,
            block: 0,
            net: None,
        }
    }

    /// Takes the first numbers from a point of a net with [`JOINT`] blocks.
    pub(crate) fn of_net(self, net: &'a Net, point: u32) -> Self {
        Self {
            net: Some((net, point)),
            ..self
        }
    }

    /// Returns the next `N` numbers.
    #[inline]
    pub(crate) fn draw<const N: usize>(&mut self) -> [f64; N] {
        if let Some(words) = self.left.get(self.used..).and_then(|left| left.first_chunk()) {
            self.used += N;
            return words.map(unit);
        }
        let mut drawn = [0.0; N];
        for number in &mut drawn {
            if self.used == self.left.len() {
                self.refill();
            }
            *number = unit(self.left[self.used]);
            self.used += 1;
        }
        drawn
    }

    fn refill(&mut self) {
        let pair = [self.block, self.block + 1].map(|block| match self.net {
            Some((net, point)) if block < JOINT => net.words(point, block),
            _ => words(self.seed, Stream::Backward, self.path, block),
        });
        self.left.copy_from_slice(pair.as_flattened());
        self.block += 2;
        self.used = 0;
    }
}
