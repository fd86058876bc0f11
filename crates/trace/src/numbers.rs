//! The random numbers from which photons are drawn.

use etendue_scene::{Run, Sampling};
use etendue_transform::Net;
use etendue_transform::random::{self, Stream};

/// The source of the random numbers of photons, and their layout.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PhotonNumbers {
    sampling: Sampling,
    seed: u64,
    /// The streams of random numbers and of nets.
    streams: [Stream; 2],
    /// The largest number of blocks of four numbers that a photon uses.
    blocks: u32,
}

/// The numbers of a block of photons.
#[derive(Debug)]
pub(crate) enum Numbers {
    Random {
        seed: u64,
        stream: Stream,
    },
    /// A net, and the photon that uses its first point.
    Net(Net, u64),
}

/// The number of points of a net, which is the number of 32-bit numbers.
const POINTS: u64 = 1 << 32;

impl PhotonNumbers {
    pub(crate) fn new(run: &Run, streams: [Stream; 2], legs: usize) -> Self {
        Self {
            sampling: run.sampling,
            seed: run.seed,
            streams,
            // The emission takes two blocks of random numbers, and each surface takes one block.
            blocks: u32::try_from(legs + 1).unwrap_or(u32::MAX),
        }
    }

    /// The numbers for photons from `start` on, in the batch that begins with photon `first`. Each
    /// batch has its own net, or several nets if it has more than 2³² photons.
    pub(crate) fn of(&self, batch: u32, first: u64, start: u64) -> Numbers {
        let Self { seed, blocks, .. } = *self;
        let [random, net] = self.streams;
        match self.sampling {
            Sampling::Random => Numbers::Random {
                seed,
                stream: random,
            },
            Sampling::Net => {
                let number = (start - first) / POINTS;
                let index = u64::from(batch) | number << 32;
                Numbers::Net(Net::new(seed, net, index, blocks), first + number * POINTS)
            }
        }
    }
}

impl Numbers {
    /// Block `block` of the numbers of a photon.
    #[inline]
    pub(crate) fn words(&self, photon: u64, block: u32) -> [u32; 4] {
        match self {
            Self::Random { seed, stream } => random::words(*seed, *stream, photon, block),
            Self::Net(net, first) => {
                let point = u32::try_from(photon - first).unwrap_or(u32::MAX);
                net.words(point, block)
            }
        }
    }
}
