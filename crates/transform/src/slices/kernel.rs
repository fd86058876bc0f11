//! The kernel that spreads a ray over cells of the fine grid.

use crate::gauss_legendre;
use fearless_simd::{Simd, f64x8, prelude::*};
use std::f64::consts::{PI, TAU};

/// Number of cells of the fine grid that a point is spread over, along each axis.
pub(crate) const WIDTH: usize = 8;

/// Half of the width. The kernel is even, so four taps determine all eight taps.
const HALF: usize = WIDTH / 2;

/// Number of cells of a period for each frequency step from zero to the largest frequency. Five
/// cells are an upsampling of 2.5.
pub(crate) const UPSAMPLING: usize = 5;

/// The parameter β of the kernel. At this upsampling, 2.35 per cell of width is the best of the
/// values 2.30, 2.35, …. The error along each axis is at most 0.8·10⁻⁷ of the amplitude of a point;
/// at an upsampling of 2 it would be 4·10⁻⁷.
const BETA: f64 = 2.35 * WIDTH as f64;

/// Number of coefficients of each parity: the taps are polynomials of degree 2 · 4 − 1 = 7.
const TERMS: usize = 4;

/// The spreading kernel "exponential of semicircle", exp(β (√(1 − z²) − 1)) on |z| ≤ 1, where z is
/// the distance from the point in units of four cells (Barnett, Magland and af Klinteberg 2019,
/// *SIAM Journal on Scientific Computing* 41(5)).
///
/// A point is spread over eight cells. If the point lies a fraction f of a cell beyond a cell of
/// the fine grid, the weight of cell j, called tap j, is the kernel at z = (j − 3 − f)/4. Each tap
/// is a polynomial in t = 2f − 1 that interpolates the kernel at Chebyshev nodes, with an error
/// below 5·10⁻⁸ of the kernel's peak. The spectrum is divided by the transform of these
/// polynomials, so their deviation from the kernel does not matter, except where it makes them less
/// smooth. A higher degree, or the kernel itself, gives the same error of the spectrum to two
/// digits.
///
/// Tap 7 − j at t is tap j at −t, so the even and odd parts of four taps determine all eight taps.
/// Products and sums are rounded separately and never fused, so every SIMD level gives bitwise the
/// same result.
#[derive(Clone, Debug)]
pub(crate) struct Kernel {
    /// Coefficients of t⁰, t², t⁴… of taps 0 to 3.
    even: [[f64; HALF]; TERMS],
    /// Coefficients of t¹, t³, t⁵… of taps 0 to 3.
    odd: [[f64; HALF]; TERMS],
}

impl Kernel {
    /// Fits the taps.
    pub(crate) fn new() -> Self {
        let mut kernel = Self {
            even: [[0.0; HALF]; TERMS],
            odd: [[0.0; HALF]; TERMS],
        };
        for tap in 0..HALF {
            let coefficients = fit(|t| exact(tap, 0.5 * (t + 1.0)));
            for i in 0..TERMS {
                kernel.even[i][tap] = coefficients[2 * i];
                kernel.odd[i][tap] = coefficients[2 * i + 1];
            }
        }
        kernel
    }

    /// Computes the eight taps of eight points. Each point lies a fraction `f` of a cell beyond its
    /// cell, and lane i of each tap belongs to point i.
    #[inline(always)]
    pub(crate) fn taps<S: Simd>(&self, simd: S, f: f64x8<S>) -> [f64x8<S>; WIDTH] {
        let t = f * 2.0 - 1.0;
        let square = t * t;
        let mut taps = [t; WIDTH];
        for tap in 0..HALF {
            let mut even = f64x8::splat(simd, self.even[TERMS - 1][tap]);
            let mut odd = f64x8::splat(simd, self.odd[TERMS - 1][tap]);
            for i in (0..TERMS - 1).rev() {
                even = even * square + self.even[i][tap];
                odd = odd * square + self.odd[i][tap];
            }
            let odd = odd * t;
            taps[tap] = even + odd;
            taps[WIDTH - 1 - tap] = even - odd;
        }
        taps
    }

    /// Computes tap `tap`, 0 to 3, for a single number. The plan and the tests use this function.
    fn tap(&self, tap: usize, f: f64) -> f64 {
        let t = 2.0 * f - 1.0;
        let horner = |terms: &[[f64; HALF]]| {
            let last_first = terms.iter().rev();
            last_first.fold(0.0, |sum, term| sum * (t * t) + term[tap])
        };
        horner(&self.even) + horner(&self.odd) * t
    }

    /// Returns the Fourier transform of the kernel, ∫ φ(d) e^(−2πi ξ d) dd, d in cells and ξ in
    /// cycles per cell.
    ///
    /// The result is the transform of the polynomials that are used for spreading. It is computed
    /// by a Gauss–Legendre rule on each cell. For |ξ| ≤ 1/2, the rule is exact apart from rounding
    /// errors.
    pub(crate) fn transform(&self, xi: f64) -> f64 {
        let mut sum = 0.0;
        for (x, weight) in gauss_legendre(16) {
            let (f, weight) = (0.5 * (1.0 + x), 0.5 * weight);
            for tap in 0..HALF {
                // Taps 4 to 7 mirror taps 3 to 0, so each pair of taps contributes twice a cosine.
                let phase = TAU * xi * (tap as f64 - 3.0 - f);
                sum += 2.0 * weight * self.tap(tap, f) * libm::cos(phase);
            }
        }
        sum
    }
}

/// Transposes eight rows of eight numbers by three perfect shuffles. The index of a number has six
/// bits, and each shuffle moves the last bit to the front.
#[inline(always)]
pub(crate) fn transposed<S: Simd>(mut rows: [f64x8<S>; WIDTH]) -> [f64x8<S>; WIDTH] {
    for _ in 0..3 {
        let before = rows;
        for i in 0..HALF {
            (rows[2 * i], rows[2 * i + 1]) = before[i].interleave(before[i + HALF]);
        }
    }
    rows
}

/// Computes tap `tap` from the kernel's formula.
fn exact(tap: usize, f: f64) -> f64 {
    let z = (tap as f64 - 3.0 - f) / HALF as f64;
    libm::exp(BETA * ((1.0 - z * z).max(0.0).sqrt() - 1.0))
}

/// Returns the coefficients of t⁰, t¹, … of the polynomial that interpolates `function` at the
/// Chebyshev nodes of [−1, 1].
fn fit(function: impl Fn(f64) -> f64) -> [f64; 2 * TERMS] {
    const N: usize = 2 * TERMS;
    let node = |i: usize| PI * (i as f64 + 0.5) / N as f64;
    let values: [f64; N] = std::array::from_fn(|i| function(libm::cos(node(i))));
    let mut coefficients = [0.0; N];
    // The Chebyshev polynomials T_n and T_(n+1), as coefficients of powers of t.
    let (mut now, mut next) = ([0.0; N], [0.0; N]);
    now[0] = 1.0;
    next[1] = 1.0;
    for n in 0..N {
        let projection: f64 = (0..N)
            .map(|i| values[i] * libm::cos(n as f64 * node(i)))
            .sum();
        let amplitude = projection * if n == 0 { 1.0 } else { 2.0 } / N as f64;
        for (c, p) in coefficients.iter_mut().zip(now) {
            *c += amplitude * p;
        }
        let after = std::array::from_fn(|i| 2.0 * if i == 0 { 0.0 } else { next[i - 1] } - now[i]);
        (now, next) = (next, after);
    }
    coefficients
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch};

    #[test]
    fn taps_follow_the_kernel_and_one_another() {
        let kernel = Kernel::new();
        let mut worst: f64 = 0.0;
        for i in 0..=1000 {
            let f = f64::from(i) / 1000.0;
            let [all, each] = dispatch!(Level::new(), simd => {
                let lanes: [f64; 8] = std::array::from_fn(|i| f / (i + 1) as f64);
                let taps = kernel.taps(simd, f64x8::load_array(simd, lanes));
                [taps, transposed(taps)].map(|taps| taps.map(|tap| tap.to_array()))
            });
            for (j, tap) in each[0].iter().enumerate() {
                worst = worst.max((tap - exact(j, f)).abs());
            }
            for (j, tap) in each[0][..HALF].iter().enumerate() {
                // The formula computes the same sums, but starts from zero.
                assert!((kernel.tap(j, f) - tap).abs() <= 1e-16);
            }
            let turned: [[f64; 8]; 8] = std::array::from_fn(|i| all.map(|tap| tap[i]));
            assert_eq!(each, turned);
        }
        assert!(worst < 5e-8, "{worst:e}"); // the bound stated at `Kernel`
    }

    #[test]
    fn transform_is_that_of_the_kernel() {
        let kernel = Kernel::new();
        for xi in [0.0, 0.11, 0.25, 0.5] {
            // Applies the midpoint rule to the formula, over 8 cells.
            let n = 20_000;
            let sum: f64 = (0..n)
                .map(|i| {
                    let d = 8.0 * (f64::from(i) + 0.5) / f64::from(n) - 4.0;
                    let semicircle = (1.0 - d * d / 16.0).sqrt();
                    libm::exp(BETA * (semicircle - 1.0)) * libm::cos(TAU * xi * d)
                })
                .sum();
            let expected = 8.0 * sum / f64::from(n);
            // The limit is eight cells times the error of the taps, which is at most 5e-8.
            assert!((kernel.transform(xi) - expected).abs() < 4e-7, "{xi}");
        }
    }
}
