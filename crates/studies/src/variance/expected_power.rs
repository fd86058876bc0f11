//! The expected power spectra E|S_m|² of samplers, in closed form.
//!
//! S_m = (1/N) Σ_j e^(−2πi m·x_j) is the spectrum of a set of N points at a whole frequency m. All
//! samplers here have E|S_m|² = Σ_t w_t Π_k a_tk(|m_k|) at m ≠ 0, where each factor a_tk is one of
//! a few functions of one coordinate. Sources: Durand 2011, *A frequency analysis of Monte-Carlo
//! and other numerical integration schemes*; Subr and Kautz 2013; Pilleboue et al. 2015, *Variance
//! analysis for Monte Carlo integration*.

use crate::variance::sampler::{AxisPairs, Sampler, cells_per_axis};
use etendue_field::sinc;
use etendue_transform::sobol_directions;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// One factor of E|S_m|² along one axis, as a function of the coordinate m ≥ 0 of the frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
enum AxisFactor {
    /// 1 at every frequency.
    One,
    /// 1 at zero, and 0 elsewhere.
    Zero,
    /// sinc²(m/n), the power of one cell among n cells.
    Cell(f64),
    /// 1 at zero, and −sinc²(m/n)/(n − 1) elsewhere: two different cells among n.
    TwoCells(f64),
    /// 2 sinc²(m/n) − sinc²(m/2n): two points of a scrambled net that share an interval of length
    /// 1/n, but not one of half this length.
    SharedDigits(f64),
}

impl AxisFactor {
    /// The factor at a coordinate of a frequency.
    fn at(self, m: f64) -> f64 {
        let cell = |n: f64| sinc(m / n) * sinc(m / n);
        match self {
            Self::One => 1.0,
            Self::Zero | Self::TwoCells(_) if m == 0.0 => 1.0,
            Self::Zero => 0.0,
            Self::Cell(n) => cell(n),
            Self::TwoCells(n) => -cell(n) / (n - 1.0),
            Self::SharedDigits(n) => 2.0 * cell(n) - cell(2.0 * n),
        }
    }

    /// The factor in a dyadic band of level s along an axis, where frequencies are replaced
    /// by halvings: cells of length 2^−l average levels s > l to 0, and keep coarser levels. Returns
    /// `None` if the number of cells is no power of two.
    fn in_band(self, level: usize) -> Option<f64> {
        let cell = |n: f64| {
            let cells = etendue_field::whole(n);
            let is_kept = (1_usize << level) <= cells;
            cells
                .is_power_of_two()
                .then_some(f64::from(u8::from(is_kept)))
        };
        Some(match self {
            Self::One => 1.0,
            Self::Zero | Self::TwoCells(_) if level == 0 => 1.0,
            Self::Zero => 0.0,
            Self::Cell(n) => cell(n)?,
            Self::TwoCells(n) => -cell(n)? / (n - 1.0),
            Self::SharedDigits(n) => 2.0 * cell(n)? - cell(2.0 * n)?,
        })
    }
}

/// The expected power spectrum E|S_m|² of a sampler with a fixed number of points, at m ≠ 0.
#[derive(Clone, Debug)]
pub struct ExpectedPower {
    factors: Vec<AxisFactor>,
    /// The weight of each term, and the index of its factor along each axis (x, u, y, v).
    terms: Vec<(f64, [usize; 4])>,
}

impl ExpectedPower {
    /// The expected power of `count` points. Returns `None` if the sampler has no sets of
    /// `count` points, or if its points come from a file.
    #[must_use]
    pub fn new(sampler: &Sampler, count: usize) -> Option<Self> {
        if !sampler.allows(count) {
            return None;
        }
        let n = count as f64;
        let one = AxisFactor::One;
        match sampler {
            Sampler::Independent => Some(Self {
                factors: vec![one],
                terms: vec![(1.0 / n, [0; 4])],
            }),
            Sampler::Jitter => Some(Self {
                factors: vec![one, AxisFactor::Cell(cells_per_axis(count, 4)? as f64)],
                terms: vec![(1.0 / n, [0; 4]), (-1.0 / n, [1; 4])],
            }),
            Sampler::LatinHypercube => Some(Self {
                factors: vec![one, AxisFactor::TwoCells(n)],
                terms: vec![(1.0 / n, [0; 4]), ((n - 1.0) / n, [1; 4])],
            }),
            Sampler::Sobol => Some(Self::net(count)),
            Sampler::Padded(pairs) => Some(Self::padded(cells_per_axis(count, 2)? as f64, *pairs)),
            Sampler::File(_) => None,
        }
    }

    /// The expected power of a net of 2^k points with Owen's scrambling.
    ///
    /// Scrambling keeps the number of leading digits that two points share along each axis. For the
    /// points i and j, these are the leading zeros of the points' exclusive or, which is again a
    /// point of the net. So the sum over all pairs is N times the sum over the points.
    fn net(count: usize) -> Self {
        let digits = count.trailing_zeros();
        let axes = [0, 1, 2, 3].map(sobol_directions);
        let mut numbers = BTreeMap::<[usize; 4], usize>::new();
        for point in 0..count {
            let shared = axes.map(|directions| {
                let bits = (0..digits as usize).filter(|bit| (point >> bit) & 1 == 1);
                let word = bits.fold(0, |word, bit| word ^ directions[bit]);
                // Digits below the first k are scrambled independently of each other.
                word.leading_zeros().min(digits) as usize
            });
            *numbers.entry(shared).or_default() += 1;
        }
        // Only the point with itself shares all digits along an axis.
        let shared_digits = |r: u32| AxisFactor::SharedDigits(libm::exp2(f64::from(r)));
        let mut factors: Vec<AxisFactor> = (0..digits).map(shared_digits).collect();
        factors.push(AxisFactor::One);
        let weight = |number: usize| number as f64 / count as f64;
        Self {
            factors,
            terms: numbers.into_iter().map(|(r, n)| (weight(n), r)).collect(),
        }
    }

    /// The expected power of two jittered sets of n² points each.
    ///
    /// If each set has the power p_m, two different points of it have the product t = (N p_m −
    /// 1)/(N − 1), which is 1 at zero and −Π sinc²(m/n)/(N − 1) elsewhere. The points are paired at
    /// random, so the product of both sets is t t′.
    fn padded(n: f64, pairs: AxisPairs) -> Self {
        let count = n * n;
        let factors = vec![AxisFactor::One, AxisFactor::Zero, AxisFactor::Cell(n)];
        // t = a δ + b sinc² sinc².
        let [a, b] = [count / (count - 1.0), -1.0 / (count - 1.0)];
        let mut terms = vec![(1.0 / count, [0; 4])];
        for (first, left) in [(a, 1), (b, 2)] {
            for (second, right) in [(a, 1), (b, 2)] {
                let mut at = [0; 4];
                for (axes, factor) in pairs.axes().into_iter().zip([left, right]) {
                    axes.into_iter().for_each(|axis| at[axis] = factor);
                }
                terms.push(((count - 1.0) / count * first * second, at));
            }
        }
        Self { factors, terms }
    }

    /// E|S_m|² at a frequency m ≠ 0 with the coordinates (x, u, y, v).
    #[must_use]
    pub fn at(&self, m: [i64; 4]) -> f64 {
        let factor =
            |index: usize, axis: usize| self.factors[index].at(m[axis].unsigned_abs() as f64);
        let term = |(weight, at): &(f64, [usize; 4])| {
            weight * (0..4).map(|axis| factor(at[axis], axis)).product::<f64>()
        };
        self.terms.iter().map(term).sum()
    }

    /// E|S_m|² at 0 ≤ m_k ≤ `max` along each axis, in row-major order.
    pub(crate) fn grid(&self, max: usize) -> Vec<f64> {
        let table = |factor: &AxisFactor| (0..=max).map(|m| factor.at(m as f64)).collect();
        self.sums(&self.factors.iter().map(table).collect::<Vec<_>>())
    }

    /// What replaces E|S_m|² in the dyadic bands 0 ≤ s_k ≤ `finest` along each axis, for sets
    /// that are not shifted, in row-major order. The variance of a mean is the sum over bands of
    /// their power times this number (Owen 1997, for nets: N times the number is the gain
    /// coefficient). Returns `None` if the cells of the sampler are no dyadic blocks.
    pub(crate) fn bands(&self, finest: usize) -> Option<Vec<f64>> {
        let table = |factor: &AxisFactor| (0..=finest).map(|level| factor.in_band(level)).collect();
        let tables: Option<Vec<Vec<f64>>> = self.factors.iter().map(table).collect();
        Some(self.sums(&tables?))
    }

    /// The means of E|S_m|² over the cells of `octaves` octaves of a dyadic tail, each as
    /// [`grid`](Self::grid) does. In octave k ≥ 1, the cell of the coordinate m ≠ 0 has the 2^k
    /// whole numbers around 2^k m, and the cell of 0 is 0 itself.
    pub(crate) fn octaves(&self, max: usize, octaves: u32) -> Vec<Vec<f64>> {
        // Sums of each factor below each coordinate.
        let end = (max << octaves) + (1 << octaves);
        let sums = self.factors.iter().map(|factor| {
            let mut sums = vec![0.0];
            for m in 0..end {
                sums.push(sums[m] + factor.at(m as f64));
            }
            sums
        });
        let sums: Vec<Vec<f64>> = sums.collect();
        let octave = |k: u32| {
            let table = |(factor, sums): (&AxisFactor, &Vec<f64>)| {
                let mean = |m: usize| {
                    let start = (m << k) - (1 << (k - 1));
                    (sums[start + (1 << k)] - sums[start]) / (1_u64 << k) as f64
                };
                let zero = factor.at(0.0);
                std::iter::once(zero).chain((1..=max).map(mean)).collect()
            };
            let tables: Vec<Vec<f64>> = self.factors.iter().zip(&sums).map(table).collect();
            self.sums(&tables)
        };
        (1..=octaves).map(octave).collect()
    }

    /// Σ_t w_t Π_k a_tk, where `tables` has the values of each factor.
    fn sums(&self, tables: &[Vec<f64>]) -> Vec<f64> {
        let n = tables.first().map_or(0, Vec::len);
        let rows = (0..n * n).into_par_iter().flat_map_iter(|row| {
            let [x, u] = [row / n, row % n];
            let outer = |(w, at): &(f64, [usize; 4])| w * tables[at[0]][x] * tables[at[1]][u];
            let outer: Vec<f64> = self.terms.iter().map(outer).collect();
            (0..n * n).map(move |column| {
                let [y, v] = [column / n, column % n];
                let terms = outer.iter().zip(&self.terms);
                terms
                    .map(|(outer, (_, at))| outer * tables[at[2]][y] * tables[at[3]][v])
                    .sum()
            })
        });
        rows.collect()
    }
}
