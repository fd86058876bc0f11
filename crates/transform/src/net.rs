//! Points of randomly scrambled Sobol' nets, addressed by index.
//!
//! A net is a set of 2ᵐ points in the unit cube. If the cube is divided into boxes by halving its
//! sides in turn, each box contains one point of the net, whereas random points form clusters and
//! gaps. Scrambling moves each point at random and preserves this property. A mean over a net is
//! therefore unbiased, and nets with different keys are independent (Owen 1997, *Scrambled net
//! variance for integrals of smooth functions*).

use crate::random::{self, Stream};

/// Number of coordinates of a block.
const WIDTH: usize = 4;
/// Number of blocks that form one net of 8 dimensions; each further block is a separate net.
const JOINT: usize = 2;

/// Degree, inner coefficients and first direction numbers of each coordinate except the first (Joe
/// and Kuo 2008, *Constructing Sobol' sequences with better two-dimensional projections*, table
/// `new-joe-kuo-6`).
const POLYNOMIALS: [(usize, u32, [u32; 5]); 9] = [
    (1, 0, [1, 0, 0, 0, 0]),
    (2, 1, [1, 3, 0, 0, 0]),
    (3, 1, [1, 3, 1, 0, 0]),
    (3, 2, [1, 1, 1, 0, 0]),
    (4, 1, [1, 1, 3, 3, 0]),
    (4, 4, [1, 3, 5, 13, 0]),
    (5, 2, [1, 1, 5, 5, 17]),
    (5, 4, [1, 1, 5, 5, 5]),
    (5, 7, [1, 1, 7, 11, 19]),
];

/// The contribution of each byte of a point's index to its coordinates, [block, byte, value];
/// contributions are combined by exclusive or. The bits of coordinates are reversed, because the
/// scrambling needs them in this order.
static ADDED: [[[[u32; WIDTH]; 256]; 4]; JOINT] = added();

/// The contribution of the lowest byte of a point's index, [block, coordinate, value].
static LOWEST: [[[u32; 256]; WIDTH]; JOINT] = lowest();

/// The contribution of each bit of a point's index to a coordinate of Sobol' points;
/// contributions are combined by exclusive or. There are ten coordinates, starting at 0.
#[must_use]
pub const fn sobol_directions(dimension: usize) -> [u32; 32] {
    let mut all = [0; 32];
    let mut bit = 0;
    while bit < 32 {
        if dimension == 0 {
            all[bit] = 1 << (31 - bit);
        } else {
            let (degree, inner, first) = POLYNOMIALS[dimension - 1];
            if bit < degree {
                all[bit] = first[bit] << (31 - bit);
            } else {
                let mut value = all[bit - degree] ^ (all[bit - degree] >> degree);
                let mut k = 1;
                while k < degree {
                    if (inner >> (degree - 1 - k)) & 1 == 1 {
                        value ^= all[bit - k];
                    }
                    k += 1;
                }
                all[bit] = value;
            }
        }
        bit += 1;
    }
    all
}

const fn added() -> [[[[u32; WIDTH]; 256]; 4]; JOINT] {
    let mut table = [[[[0; WIDTH]; 256]; 4]; JOINT];
    let mut dimension = 0;
    while dimension < WIDTH * JOINT {
        let directions = sobol_directions(dimension);
        let mut bit = 0;
        while bit < 32 {
            let mut value = 0;
            while value < 256 {
                if (value >> (bit % 8)) & 1 == 1 {
                    table[dimension / WIDTH][bit / 8][value][dimension % WIDTH] ^=
                        directions[bit].reverse_bits();
                }
                value += 1;
            }
            bit += 1;
        }
        dimension += 1;
    }
    table
}

const fn lowest() -> [[[u32; 256]; WIDTH]; JOINT] {
    let mut table = [[[0; 256]; WIDTH]; JOINT];
    let mut i = 0;
    while i < JOINT * WIDTH * 256 {
        let [block, k, value] = [i / (WIDTH * 256), i / 256 % WIDTH, i % 256];
        table[block][k][value] = ADDED[block][0][value][k];
        i += 1;
    }
    table
}

/// The scrambling of a block of coordinates: an addend and a multiplier.
#[derive(Clone, Copy, Debug)]
struct Keys {
    added: [u32; WIDTH],
    factors: [u32; WIDTH],
    /// The addend and multiplier that scramble the order of the points.
    order: [u32; 2],
}

/// A net of 2³² points, scrambled with its own keys.
#[derive(Clone, Debug)]
pub struct Net {
    /// The keys of each block.
    keys: Vec<Keys>,
}

impl Net {
    /// Returns net number `index` for a stream of `seed`, with `blocks` blocks of four coordinates.
    #[must_use]
    pub fn new(seed: u64, stream: Stream, index: u64, blocks: u32) -> Self {
        let words = |block: u32| random::words(seed, stream, index, block);
        let keys = (0..blocks).map(|block| {
            let [added, factors, [a, b, ..]] = [0, 1, 2].map(|i| words(3 * block + i));
            let order = [a, b];
            Keys {
                added,
                factors,
                order,
            }
        });
        Self {
            keys: keys.collect(),
        }
    }

    /// Returns block `block` of a point, as random words. Any 2ᵐ points that start at a multiple of
    /// 2ᵐ are a net.
    #[inline]
    #[must_use]
    pub fn words(&self, point: u32, block: u32) -> [u32; WIDTH] {
        let keys = &self.keys[block as usize];
        let reversed = keys.reversed(point, block as usize);
        std::array::from_fn(|k| hashed(reversed[k], keys.coordinate(k)))
    }

    /// Returns [`Self::words`] of `N` points from the point `first` on, as a column for each
    /// coordinate. The compiler can vectorise the function if `first` is a multiple of `N`.
    #[inline(always)]
    #[must_use]
    pub fn columns<const N: usize>(&self, first: u32, block: u32) -> [[u32; N]; WIDTH] {
        let mut columns = [[0; N]; WIDTH];
        let keys = &self.keys[block as usize];
        let is_aligned = N.is_power_of_two() && (first as usize).is_multiple_of(N);
        match LOWEST.get(block as usize) {
            // Points of the group differ only in the lowest bits of the index.
            Some(lowest) if N <= 256 && is_aligned => {
                let reversed = keys.reversed(first, block as usize);
                for (k, column) in columns.iter_mut().enumerate() {
                    for (word, lowest) in column.iter_mut().zip(&lowest[k]) {
                        *word = hashed(reversed[k] ^ lowest, keys.coordinate(k));
                    }
                }
            }
            _ => {
                for (i, point) in (0..N).zip(first..=u32::MAX) {
                    let words = self.words(point, block);
                    for (column, word) in columns.iter_mut().zip(words) {
                        column[i] = word;
                    }
                }
            }
        }
        columns
    }
}

impl Keys {
    /// The coordinates of a point without scrambling, as words of reversed bits.
    #[inline(always)]
    fn reversed(&self, point: u32, block: usize) -> [u32; WIDTH] {
        // The first blocks form a joint net; further blocks are combined with it in a random order.
        let (table, point) = if block < JOINT {
            (&ADDED[block], point)
        } else {
            (&ADDED[0], hashed(point.reverse_bits(), self.order))
        };
        let [a, b, c, d] = point.to_le_bytes().map(usize::from);
        let [a, b, c, d] = [&table[0][a], &table[1][b], &table[2][c], &table[3][d]];
        std::array::from_fn(|k| a[k] ^ b[k] ^ c[k] ^ d[k])
    }

    /// The addend and multiplier that scramble a coordinate.
    #[inline(always)]
    fn coordinate(&self, k: usize) -> [u32; 2] {
        [self.added[k], self.factors[k]]
    }
}

/// Applies Owen scrambling by a hash to a number whose bits are given in reversed order. In Owen
/// scrambling, the change of each bit depends only on the bits above it, so the hash is applied to
/// the reversed bits (Laine and Karras 2011). The hash is from Vegdahl 2021, *Building a better LK
/// hash*, with one change: the multiplier is independent of the addend, so all numbers are equally
/// likely.
#[inline(always)]
fn hashed(mut x: u32, [added, factor]: [u32; 2]) -> u32 {
    x ^= x.wrapping_mul(0x3D20_ADEA);
    x = x.wrapping_add(added);
    x = x.wrapping_mul(factor | 1);
    x ^= x.wrapping_mul(0x0552_6C56);
    x ^= x.wrapping_mul(0x53A2_2864);
    x.reverse_bits()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::unit;

    /// Total number of coordinates of three blocks. Two of these blocks share a net, and one block
    /// has its own net.
    const ALL: usize = 3 * WIDTH;

    fn points(key: u64, count: u32) -> Vec<[f64; ALL]> {
        let net = Net::new(7, Stream::Net, key, 3);
        let point = |i| {
            let blocks = [0, 1, 2].map(|block| net.words(i, block).map(unit));
            std::array::from_fn(|k| blocks[k / WIDTH][k % WIDTH])
        };
        (0..count).map(point).collect()
    }

    fn cell(x: f64, n: u32) -> usize {
        (1..n)
            .take_while(|i| f64::from(*i) <= x * f64::from(n))
            .count()
    }

    /// Tests 2ᵐ points of a net. Along each coordinate, every interval of length 2⁻ᵐ contains one
    /// point. In the plane of the first two coordinates of a block, every box of area 2⁻ᵐ that is
    /// formed by halving sides contains one point.
    #[test]
    fn boxes_hold_one_point_each() {
        const N: u32 = 256;
        for key in 0..3 {
            let points = points(key, N);
            for k in 0..ALL {
                let mut count = [0; N as usize];
                points.iter().for_each(|p| count[cell(p[k], N)] += 1);
                assert_eq!(count, [1; N as usize], "coordinate {k} of net {key}");
            }
            for (k, columns) in [0, 2 * WIDTH]
                .into_iter()
                .flat_map(|k| [4, 16, 64].map(|n| (k, n)))
            {
                let rows = N / columns;
                let mut count = [0; N as usize];
                for p in &points {
                    count[cell(p[k], columns) * rows as usize + cell(p[k + 1], rows)] += 1;
                }
                assert_eq!(count, [1; N as usize], "{columns} columns of net {key}");
            }
        }
    }

    /// Tests that the mean of a product over all coordinates is unbiased and has less noise than
    /// with random numbers. The test is repeated for the coordinates of one block.
    #[test]
    fn nets_beat_random_numbers() {
        const N: u32 = 1 << 12;
        const NETS: u64 = 64;
        for (from, to, less) in [(0, WIDTH, 1e-3), (0, 2 * WIDTH, 1e-2), (0, ALL, 0.1)] {
            let f = |p: &[f64; ALL]| -> f64 {
                p[from..to].iter().map(|x| 1.0 + 0.5 * (x - 0.5)).product()
            };
            let errors = (0..NETS).map(|key| {
                let sum: f64 = points(key, N).iter().map(f).sum();
                sum / f64::from(N) - 1.0
            });
            let errors: Vec<f64> = errors.collect();
            let power = errors.iter().map(|e| e * e).sum::<f64>() / NETS as f64;
            let factors = i32::try_from(to - from).unwrap();
            let random = ((1.0_f64 + 0.25 / 12.0).powi(factors) - 1.0) / f64::from(N);
            assert!(power < less * random, "{from}..{to}: {:e}", power / random);
            let mean = errors.iter().sum::<f64>() / NETS as f64;
            // The limit is four standard errors of the mean.
            assert!(
                mean.abs() < 4.0 * (power / NETS as f64).sqrt(),
                "{from}..{to}"
            );
        }
    }

    #[test]
    fn columns_are_words_of_points() {
        let net = Net::new(7, Stream::Net, 0, 3);
        for first in [0, 16, 48, 250, 0x0123_4560, 0xFFFF_FFE0] {
            for block in 0..3 {
                let columns = net.columns::<16>(first, block);
                for i in 0..16 {
                    let words = columns.map(|column| column[i as usize]);
                    assert_eq!(words, net.words(first + i, block), "{first} + {i}");
                }
            }
        }
    }

    /// The expected values are points 5, 16 and 32, times 64. They are computed by
    /// `scipy.stats.qmc.Sobol(8, scramble=False)` of SciPy 1.17, where these points have the
    /// numbers 6, 31 and 63, because SciPy orders points by Gray code.
    #[test]
    fn points_are_those_of_sobol() {
        let point = |[low, high]: [usize; 2]| -> Vec<u32> {
            let words = (0..JOINT).flat_map(|block| {
                let [a, b] = [ADDED[block][0][low], ADDED[block][0][high]];
                (0..WIDTH).map(move |k| a[k] ^ b[k])
            });
            words.map(|word| word.reverse_bits() >> 26).collect()
        };
        assert_eq!(point([5, 0]), [40, 8, 56, 40, 40, 56, 8, 8]);
        assert_eq!(point([16, 0]), [2, 34, 58, 62, 62, 50, 22, 34]);
        assert_eq!(point([32, 0]), [1, 51, 23, 29, 55, 9, 37, 9]);
        assert_eq!(point([4, 1]), point([5, 0]));
    }
}
