//! Provides the random numbers with which photons are drawn.

use crate::lattice::{LatticePoints, Lattices};
use etendue_scene::{RunSettings, Sampling};
use etendue_transform::Net;
use etendue_transform::random::{self, Stream};
use fearless_simd::{Level, dispatch};
use std::ops::Range;

/// The source of the random numbers of photons, with their division into blocks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PhotonNumbers {
    sampling: Sampling,
    seed: u64,
    /// The streams of random numbers, nets and lattices.
    streams: [Stream; 3],
    /// The maximum number of blocks, of four random numbers each, that a photon uses.
    blocks: u32,
}

/// The numbers of a block of photons.
#[derive(Debug)]
pub(crate) enum Numbers {
    Random {
        seed: u64,
        stream: Stream,
    },
    /// A net, and the number of the photon that uses the net's first point.
    Net(Net, u64),
    /// A lattice for the emission, and a net for everything else.
    Lattice(LatticePoints, Net, u64),
}

/// The number of points of a net, which equals the number of values of a 32-bit word.
const POINTS: u64 = 1 << 32;

impl PhotonNumbers {
    pub(crate) fn new(run: &RunSettings, streams: [Stream; 3], legs: usize) -> Self {
        Self {
            sampling: run.sampling,
            seed: run.seed,
            streams,
            // The emission takes two blocks of random numbers, and each surface takes one block.
            blocks: u32::try_from(legs + 1).unwrap_or(u32::MAX),
        }
    }

    /// The random numbers for the photons with the numbers `start` and above. The photons of
    /// their batch have the numbers `range`. Each batch has its own net, or several nets if it has
    /// more than 2³² photons.
    pub(crate) fn of(
        &self,
        batch: u32,
        range: &Range<u64>,
        start: u64,
        lattices: Option<&Lattices>,
    ) -> Numbers {
        let Self { seed, blocks, .. } = *self;
        let [random, net, lattice] = self.streams;
        if self.sampling == Sampling::Random {
            return Numbers::Random {
                seed,
                stream: random,
            };
        }
        let number = (start - range.start) / POINTS;
        let index = u64::from(batch) | number << 32;
        let (net, first) = (
            Net::new(seed, net, index, blocks),
            range.start + number * POINTS,
        );
        match lattices {
            Some(lattices) => {
                Numbers::Lattice(lattices.of(seed, lattice, batch, range), net, first)
            }
            None => Numbers::Net(net, first),
        }
    }
}

impl Numbers {
    /// Returns block `block` of the random numbers of a photon.
    #[inline]
    pub(crate) fn words(&self, photon: u64, block: u32) -> [u32; 4] {
        match self {
            Self::Random { seed, stream } => random::words(*seed, *stream, photon, block),
            Self::Net(net, first) | Self::Lattice(_, net, first) => {
                net.words(point(photon, *first), block)
            }
        }
    }

    /// Returns [`Self::words`] of `N` photons from `photon` on, as a column for each word.
    pub(crate) fn columns<const N: usize>(
        &self,
        level: Level,
        photon: u64,
        block: u32,
    ) -> [[u32; N]; 4] {
        if let Self::Net(net, first) | Self::Lattice(_, net, first) = self {
            let point = point(photon, *first);
            return dispatch!(level, _simd => net.columns(point, block));
        }
        let mut columns = [[0; N]; 4];
        for (i, photon) in (0..N).zip(photon..) {
            let words = self.words(photon, block);
            for (column, word) in columns.iter_mut().zip(words) {
                column[i] = word;
            }
        }
        columns
    }
}

/// The point of a net that a photon uses, where the photon `first` uses the first point.
#[inline]
fn point(photon: u64, first: u64) -> u32 {
    u32::try_from(photon - first).unwrap_or(u32::MAX)
}
