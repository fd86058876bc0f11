//! The random numbers of a path.

use etendue_transform::Net;
use etendue_transform::random::{Stream, columns, unit, words};
use fearless_simd::{Level, dispatch};

/// The sequence of random numbers of one path, in (0, 1).
#[derive(Clone, Copy, Debug)]
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

/// Number of paths whose numbers are computed together.
const GROUP: usize = 8;

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

    /// The next `N` numbers.
    #[inline]
    pub(crate) fn draw<const N: usize>(&mut self) -> [f64; N] {
        if let Some(words) = self.left[self.used..].first_chunk::<N>() {
            self.used += N;
            return std::array::from_fn(|i| unit(words[i]));
        }
        let mut drawn = [0.0; N];
        for number in &mut drawn {
            if self.is_empty() {
                self.refill();
            }
            *number = unit(self.left[self.used]);
            self.used += 1;
        }
        drawn
    }

    fn is_empty(&self) -> bool {
        self.used == self.left.len()
    }

    fn refill(&mut self) {
        let block = |next: u32| words(self.seed, Stream::Backward, self.path, self.block + next);
        self.accept([block(0), block(1)]);
    }

    /// Takes the next two blocks, or those of the net instead.
    fn accept(&mut self, blocks: [[u32; 4]; 2]) {
        for (place, words) in self.left.chunks_exact_mut(4).zip(blocks) {
            place.copy_from_slice(&match self.net {
                Some((net, point)) if self.block < JOINT => net.words(point, self.block),
                _ => words,
            });
            self.block += 1;
        }
        self.used = 0;
    }

    /// Computes the next numbers of the paths of `items` that have used all of theirs, which is
    /// faster for several paths together.
    pub(crate) fn prepare<T>(items: &mut [T], numbers: impl Fn(&mut T) -> &mut Self) {
        let level = Level::new();
        for group in items.chunks_mut(GROUP) {
            if !group.iter_mut().any(|item| numbers(item).is_empty()) {
                continue;
            }
            let (mut seeds, mut paths) = ([0; GROUP], [0; GROUP]);
            let mut blocks = [[0; GROUP]; 2];
            for (k, item) in group.iter_mut().enumerate() {
                let of = numbers(item);
                (seeds[k], paths[k]) = (of.seed, of.path);
                (blocks[0][k], blocks[1][k]) = (of.block, of.block + 1);
            }
            let [first, second] = dispatch!(level, _simd => [
                columns(&seeds, Stream::Backward, &paths, &blocks[0]),
                columns(&seeds, Stream::Backward, &paths, &blocks[1]),
            ]);
            for (k, item) in group.iter_mut().enumerate() {
                let of = numbers(item);
                if of.is_empty() {
                    of.accept([&first, &second].map(|columns| columns.map(|column| column[k])));
                }
            }
        }
    }
}
