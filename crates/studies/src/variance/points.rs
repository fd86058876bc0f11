//! Sets of points that samplers place in the window.

use crate::variance::sampler::{AxisPairs, Sampler, WindowPoint, cells_per_axis, indices};
use etendue_transform::Net;
use etendue_transform::random::{Stream, index, unit, words};

/// A sequence of random words that belongs to one set of points.
struct WordSequence {
    seed: u64,
    set: u64,
    block: u32,
    words: [u32; 4],
    used: usize,
}

impl WordSequence {
    fn new(seed: u64, set: u64) -> Self {
        Self {
            seed,
            set,
            block: 0,
            words: words(seed, Stream::Points, set, 0),
            used: 0,
        }
    }

    fn word(&mut self) -> u32 {
        if self.used == self.words.len() {
            self.block += 1;
            self.words = words(self.seed, Stream::Points, self.set, self.block);
            self.used = 0;
        }
        self.used += 1;
        self.words[self.used - 1]
    }

    fn unit(&mut self) -> f64 {
        unit(self.word())
    }

    /// The numbers 0 to `count` − 1 in a random order (Fisher and Yates).
    fn permutation(&mut self, count: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..count).collect();
        for last in (1..count).rev() {
            order.swap(last, index(self.word(), last + 1));
        }
        order
    }

    /// One random point in each of n² cells.
    fn jittered_square(&mut self, n: usize) -> Vec<[f64; 2]> {
        let mut point =
            |cell: usize| [cell / n, cell % n].map(|at| (at as f64 + self.unit()) / n as f64);
        (0..n * n).map(&mut point).collect()
    }
}

/// Returns set number `set` of `count` points, without a shift. A set depends on `seed` and `set`
/// alone. Returns `None` if the sampler has no sets of `count` points.
#[must_use]
pub fn points(sampler: &Sampler, count: usize, seed: u64, set: u64) -> Option<Vec<WindowPoint>> {
    if !sampler.allows(count) {
        return None;
    }
    let mut random = WordSequence::new(seed, set);
    Some(match sampler {
        Sampler::Independent => (0..count).map(|_| [0; 4].map(|_| random.unit())).collect(),
        Sampler::Jitter => {
            let n = cells_per_axis(count, 4)?;
            let mut point =
                |cell: usize| indices(cell, n).map(|at| (at as f64 + random.unit()) / n as f64);
            (0..count).map(&mut point).collect()
        }
        Sampler::LatinHypercube => {
            let mut set = vec![[0.0; 4]; count];
            for axis in 0..4 {
                for (point, at) in set.iter_mut().zip(random.permutation(count)) {
                    point[axis] = (at as f64 + random.unit()) / count as f64;
                }
            }
            set
        }
        Sampler::Sobol => {
            let net = Net::new(seed, Stream::Points, set, 1);
            let count = u32::try_from(count).ok()?;
            (0..count).map(|i| net.words(i, 0).map(unit)).collect()
        }
        Sampler::Padded(pairs) => padded(cells_per_axis(count, 2)?, *pairs, &mut random),
        Sampler::File(file) => file.points.to_vec(),
    })
}

/// Two jittered sets of n² points, paired at random.
fn padded(n: usize, pairs: AxisPairs, random: &mut WordSequence) -> Vec<WindowPoint> {
    let first = random.jittered_square(n);
    let second = random.jittered_square(n);
    let [one, other] = pairs.axes();
    let order = random.permutation(n * n);
    let paired = first.into_iter().zip(order).map(|(a, at)| {
        let b = second[at];
        let mut point = [0.0; 4];
        for i in 0..2 {
            point[one[i]] = a[i];
            point[other[i]] = b[i];
        }
        point
    });
    paired.collect()
}

/// Shifts points on the torus \[0, 1)⁴ by the random vector of set number `set`.
pub fn shift(points: &mut [WindowPoint], seed: u64, set: u64) {
    let by = words(seed, Stream::Shift, set, 0).map(unit);
    for point in points {
        for (z, by) in point.iter_mut().zip(by) {
            let moved = *z + by;
            *z = if moved < 1.0 { moved } else { moved - 1.0 };
        }
    }
}
