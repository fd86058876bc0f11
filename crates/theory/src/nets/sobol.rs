//! Points of Sobol' nets that are scrambled independently.
//!
//! A net is a set of 2ᵐ points in the unit cube. If the cube is divided into boxes by halving its
//! sides in turn, each box contains one point of the net. Scrambling moves each point at random and
//! preserves this property. The mean over a net is therefore an unbiased estimate, and nets that
//! are scrambled with different keys are independent (Owen 1997).

use etendue_transform::random::unit;
use etendue_transform::sobol_directions;

/// The largest number of coordinates of a point.
pub(crate) const DIMENSIONS: usize = 10;

/// The contribution of each bit of a point's index to its coordinates; contributions are combined
/// by exclusive or.
static DIRECTIONS: [[u32; 32]; DIMENSIONS] = {
    let mut all = [[0; 32]; DIMENSIONS];
    let mut dimension = 0;
    while dimension < DIMENSIONS {
        all[dimension] = sobol_directions(dimension);
        dimension += 1;
    }
    all
};

/// A generator of the points of a scrambled net, in order of their index.
#[derive(Clone, Debug)]
pub(crate) struct NetPoints {
    keys: [u32; DIMENSIONS],
    unscrambled: [u32; DIMENSIONS],
    next: u32,
    dimensions: usize,
}

impl NetPoints {
    /// The net scrambled with key `replicate`. The given number of coordinates of each
    /// point are computed; the remaining coordinates are 0.
    pub(crate) fn new(replicate: u32, dimensions: usize) -> Self {
        let key = |dimension: u32| {
            let mixed = replicate.wrapping_mul(0x9E37_79B9) ^ dimension.wrapping_mul(0x85EB_CA6B);
            mixed_bits(mixed.wrapping_add(0x7F4A_7C15))
        };
        Self {
            keys: [0, 1, 2, 3, 4, 5, 6, 7, 8, 9].map(key),
            unscrambled: [0; DIMENSIONS],
            next: 0,
            dimensions,
        }
    }

    /// The next point. Any 2ᵐ consecutive points form a net if the index of the first is a
    /// multiple of 2ᵐ.
    pub(crate) fn point(&mut self) -> [f64; DIMENSIONS] {
        let mut point = [0.0; DIMENSIONS];
        for (k, x) in point[..self.dimensions].iter_mut().enumerate() {
            *x = unit(scrambled(self.unscrambled[k], self.keys[k]));
        }
        // In Gray-code order, consecutive indices differ in one bit.
        self.next = self.next.wrapping_add(1);
        let bit = self.next.trailing_zeros() as usize & 31;
        for (value, directions) in self.unscrambled.iter_mut().zip(&DIRECTIONS) {
            *value ^= directions[bit];
        }
        point
    }
}

/// Owen scrambling by a hash in which each bit depends only on the bits above it (Laine and Karras
/// 2011; constants of Burley 2020, *Practical hash-based Owen scrambling*).
fn scrambled(value: u32, key: u32) -> u32 {
    let mut x = value.reverse_bits();
    x = x.wrapping_add(key);
    for factor in [0x6C50_B47C_u32, 0xB82F_1E52, 0xC7AF_E638, 0x8D22_F6E6] {
        x ^= x.wrapping_mul(factor);
    }
    x.reverse_bits()
}

/// A hash of 32 bits in which every bit of the result depends on every bit of the input (the
/// finaliser of `MurmurHash3`).
fn mixed_bits(mut x: u32) -> u32 {
    x = (x ^ (x >> 16)).wrapping_mul(0x85EB_CA6B);
    x = (x ^ (x >> 13)).wrapping_mul(0xC2B2_AE35);
    x ^ (x >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The index of the cell that contains `x` if (0, 1) is divided into n equal cells.
    fn cell(x: f64, n: usize) -> usize {
        (1..n).take_while(|i| *i as f64 <= x * n as f64).count()
    }

    /// Tests that each box of volume 2⁻ᵐ formed by repeatedly halving two sides of the unit cube
    /// contains exactly one of 2ᵐ points.
    #[test]
    fn pairs_of_first_coordinates_are_nets() {
        for replicate in 0..3 {
            let mut net = NetPoints::new(replicate, DIMENSIONS);
            for _ in 0..4 {
                let points: Vec<_> = (0..256).map(|_| net.point()).collect();
                for columns in [1_usize, 4, 16, 256] {
                    let rows = 256 / columns;
                    let mut count = vec![0; 256];
                    for p in &points {
                        count[cell(p[0], columns) * rows + cell(p[1], rows)] += 1;
                    }
                    assert!(count.iter().all(|n| *n == 1), "{replicate} {columns}");
                }
                for k in 0..DIMENSIONS {
                    let mut count = [0; 256];
                    for p in &points {
                        count[cell(p[k], 256)] += 1;
                    }
                    assert_eq!(count, [1; 256], "coordinate {k}");
                }
            }
        }
    }

    /// Tests that the error of a mean of a smooth function of all coordinates is much smaller with
    /// nets than with random points.
    #[test]
    fn nets_beat_random_points() {
        let f = |p: &[f64; DIMENSIONS]| p.iter().map(|x| 1.0 + 0.5 * (x - 0.5)).product::<f64>();
        let n = 1 << 12;
        let errors = (0..32).map(|replicate| {
            let mut net = NetPoints::new(replicate, DIMENSIONS);
            let mean = (0..n).map(|_| f(&net.point())).sum::<f64>() / f64::from(n);
            mean - 1.0
        });
        let errors: Vec<f64> = errors.collect();
        let power = errors.iter().map(|e| e * e).sum::<f64>() / 32.0;
        let variance = (1.0_f64 + 0.25 / 12.0).powi(10) - 1.0;
        let random = variance / f64::from(n);
        assert!(power < 1e-3 * random, "{:e}", power / random); // Sobol' at 2¹² of 10: 10⁻⁴
        // The nets are unbiased: the mean error of 32 independent nets is within four standard
        // errors of zero.
        let mean = errors.iter().sum::<f64>() / 32.0;
        assert!(mean.abs() < 4.0 * (power / 32.0).sqrt());
    }
}
