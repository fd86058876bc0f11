//! The random numbers of a path.

use etendue_transform::Net;
use etendue_transform::random::{Stream, unit, words};

/// The sequence of random numbers of one path, in (0, 1).
#[derive(Debug)]
pub(crate) struct PathNumbers<'a> {
    seed: u64,
    path: u64,
    block: u32,
    left: [u32; 4],
    used: usize,
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
            block: 0,
            left: [0; 4],
            used: 4,
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

    fn next(&mut self) -> f64 {
        if self.used == 4 {
            self.left = match self.net {
                Some((net, point)) if self.block < JOINT => net.words(point, self.block),
                _ => words(self.seed, Stream::Backward, self.path, self.block),
            };
            self.block += 1;
            self.used = 0;
        }
        self.used += 1;
        unit(self.left[self.used - 1])
    }

    /// Returns the next `N` numbers.
    pub(crate) fn draw<const N: usize>(&mut self) -> [f64; N] {
        [(); N].map(|()| self.next())
    }
}
