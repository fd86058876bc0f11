//! The kernel that spreads a ray over cells of the fine grid.

use crate::gauss_legendre;
use fearless_simd::{Simd, prelude::*};
use std::f64::consts::{PI, TAU};

/// The largest number of cells of the fine grid that a point is spread over, along each axis.
pub(crate) const WIDTH: usize = 8;

/// Number of cells of a period for each frequency step from zero to the largest frequency. Five
/// cells are an upsampling of 2.5.
pub(crate) const UPSAMPLING: usize = 5;

/// The parameter β of the kernel, divided by its width. At an upsampling of 2.5, this is the best of
/// the values 2.30, 2.35, … for six and for eight taps.
const BETA: f64 = 2.45;

/// Number of coefficients of a tap, which is a polynomial of degree 7.
const TERMS: usize = 8;

/// The spreading kernel "exponential of semicircle", exp(β (√(1 − z²) − 1)) on |z| ≤ 1, where z is
/// the distance from the point in units of half the kernel's width (Barnett, Magland and af
/// Klinteberg 2019, *SIAM Journal on Scientific Computing* 41(5)).
///
/// A point is spread over an even number of cells. If the point lies a fraction f of a cell beyond
/// a cell of the fine grid, the weight of cell j, called tap j, is the kernel at z = (j + 1 − f)/h −
/// 1, where h is half the number of taps. Each tap is a polynomial in t = 2f − 1 that interpolates
/// the kernel at Chebyshev nodes, with an error below 5·10⁻⁸ of the kernel's peak for
/// eight taps, and 4·10⁻⁷ for six. The spectrum is divided by the transform of these polynomials,
/// so their deviation from the kernel does not matter, except where it makes them less smooth. A
/// higher degree, or the kernel itself, gives the same error of the spectrum to two digits.
///
/// The error along each axis is at most 0.9·10⁻⁷ of the amplitude of a point with eight taps, and
/// 6.4·10⁻⁶ with six.
///
/// The last tap at t is the first tap at −t, so the even and odd parts of half the taps determine
/// all taps. Products and sums are rounded separately and never fused, so every SIMD level gives
/// bitwise the same result.
#[derive(Clone, Debug)]
pub(crate) struct Kernel<T, const TAPS: usize> {
    /// The coefficients of t⁰, t¹, … of each tap.
    terms: [[T; TERMS]; TAPS],
}

impl<const TAPS: usize> Kernel<f64, TAPS> {
    /// Fits the taps.
    pub(crate) fn new() -> Self {
        let mut terms = [[0.0; TERMS]; TAPS];
        for tap in 0..TAPS / 2 {
            terms[tap] = fit(|t| exact::<TAPS>(tap, 0.5 * (t + 1.0)));
            let mut mirrored = terms[tap];
            mirrored
                .iter_mut()
                .skip(1)
                .step_by(2)
                .for_each(|term| *term = -*term);
            terms[TAPS - 1 - tap] = mirrored;
        }
        Self { terms }
    }

    /// The same kernel with coefficients in single precision.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the error of six taps is larger than that of f32"
    )]
    pub(crate) fn single(&self) -> Kernel<f32, TAPS> {
        Kernel {
            terms: self.terms.map(|terms| terms.map(|term| term as f32)),
        }
    }

    /// Computes a tap for a single number. The plan and the tests use this function.
    fn tap(&self, tap: usize, f: f64) -> f64 {
        let t = 2.0 * f - 1.0;
        let horner = |first: usize| {
            let terms = self.terms[tap][first..].iter().step_by(2);
            terms.rev().fold(0.0, |sum, term| sum * (t * t) + term)
        };
        horner(0) + horner(1) * t
    }

    /// The Fourier transform of the kernel, ∫ φ(d) e^(−2πi ξ d) dd, d in cells and ξ in
    /// cycles per cell.
    ///
    /// The result is the transform of the polynomials that are used for spreading. It is computed
    /// by a Gauss–Legendre rule on each cell. For |ξ| ≤ 1/2, the rule is exact apart from rounding
    /// errors.
    pub(crate) fn transform(&self, xi: f64) -> f64 {
        let mut sum = 0.0;
        for (x, weight) in gauss_legendre(16) {
            let (f, weight) = (0.5 * (1.0 + x), 0.5 * weight);
            for tap in 0..TAPS {
                // The kernel is even, so the sines of its transform cancel.
                let phase = TAU * xi * (tap as f64 + 1.0 - f - 0.5 * TAPS as f64);
                sum += weight * self.tap(tap, f) * libm::cos(phase);
            }
        }
        sum
    }
}

impl<const TAPS: usize> Kernel<f32, TAPS> {
    /// The same kernel with the same coefficients in double precision.
    pub(crate) fn double(&self) -> Kernel<f64, TAPS> {
        Kernel {
            terms: self.terms.map(|terms| terms.map(f64::from)),
        }
    }
}

impl<T: Copy, const TAPS: usize> Kernel<T, TAPS> {
    /// Computes the taps of several points at t = 2f − 1. Lane i of each tap belongs to point i.
    #[inline(always)]
    pub(crate) fn taps<S: Simd, V: SimdFloat<S, Element = T>>(&self, simd: S, t: V) -> [V; TAPS] {
        let square = t * t;
        let mut taps = [t; TAPS];
        for tap in 0..TAPS / 2 {
            let terms = &self.terms[tap];
            let mut even = V::splat(simd, terms[TERMS - 2]);
            let mut odd = V::splat(simd, terms[TERMS - 1]);
            for i in (0..TERMS / 2 - 1).rev() {
                even = even * square + V::splat(simd, terms[2 * i]);
                odd = odd * square + V::splat(simd, terms[2 * i + 1]);
            }
            let odd = odd * t;
            taps[tap] = even + odd;
            taps[TAPS - 1 - tap] = even - odd;
        }
        taps
    }
}

/// Transposes eight rows by three perfect shuffles, each of which moves the first bit of a number's
/// index to the end. The result, read row by row, holds the first number of each row, then the
/// second number of each row, and so on.
#[inline(always)]
pub(crate) fn transposed<S: Simd, V: SimdBase<S>>(mut rows: [V; 8]) -> [V; 8] {
    for _ in 0..3 {
        let before = rows;
        for i in 0..4 {
            (rows[2 * i], rows[2 * i + 1]) = before[i].interleave(before[i + 4]);
        }
    }
    rows
}

/// Computes a tap from the kernel's formula.
fn exact<const TAPS: usize>(tap: usize, f: f64) -> f64 {
    let z = (tap as f64 + 1.0 - f) / (0.5 * TAPS as f64) - 1.0;
    libm::exp(BETA * TAPS as f64 * ((1.0 - z * z).max(0.0).sqrt() - 1.0))
}

/// The coefficients of t⁰, t¹, … of the polynomial that interpolates `function` at the
/// Chebyshev nodes of [−1, 1].
fn fit(function: impl Fn(f64) -> f64) -> [f64; TERMS] {
    const N: usize = TERMS;
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
    use fearless_simd::{Level, dispatch, f32x8, f32x16, f64x8};

    #[test]
    fn taps_follow_the_kernel_and_one_another() {
        compare_taps::<8>(5e-8);
        compare_taps::<6>(4e-7);
    }

    fn compare_taps<const TAPS: usize>(bound: f64) {
        let kernel = Kernel::<f64, TAPS>::new();
        let single = kernel.single();
        let mut worst: f64 = 0.0;
        for i in 0..=1000 {
            let f = f64::from(i) / 1000.0;
            #[expect(clippy::cast_possible_truncation, reason = "f32 is tested")]
            let (taps, short) = dispatch!(Level::new(), simd => {
                let lanes: [f64; 8] = std::array::from_fn(|i| 2.0 * f / (i + 1) as f64 - 1.0);
                let taps = kernel.taps(simd, f64x8::load_array(simd, lanes));
                let short = lanes.map(|t| t as f32);
                let short = single.taps(simd, f32x8::load_array(simd, short));
                (taps.map(|tap| tap.to_array()), short.map(|tap| tap.to_array()))
            });
            for (j, (tap, short)) in taps.iter().zip(&short).enumerate() {
                worst = worst.max((tap[0] - exact::<TAPS>(j, f)).abs());
                // The formula computes the same sums, but starts from zero.
                assert!((kernel.tap(j, f) - tap[0]).abs() <= 1e-16);
                // The limit is the rounding error of a polynomial of f32.
                assert!((f64::from(short[0]) - tap[0]).abs() <= 3e-7);
            }
        }
        assert!(worst < bound, "{worst:e}"); // the bound stated at `Kernel`
    }

    #[test]
    fn rows_become_columns() {
        let rows: [[f64; 8]; 8] =
            std::array::from_fn(|i| std::array::from_fn(|j| (8 * i + j) as f64));
        let turned = dispatch!(Level::new(), simd => {
            transposed(rows.map(|row| f64x8::load_array(simd, row))).map(|row| row.to_array())
        });
        let expected: [[f64; 8]; 8] = std::array::from_fn(|i| rows.map(|row| row[i]));
        assert_eq!(turned, expected);
        let long: [[f32; 16]; 8] =
            std::array::from_fn(|i| std::array::from_fn(|j| (16 * i + j) as f32));
        let turned = dispatch!(Level::new(), simd => {
            transposed(long.map(|row| f32x16::load_array(simd, row))).map(|row| row.to_array())
        });
        let expected: [[f32; 8]; 16] = std::array::from_fn(|i| long.map(|row| row[i]));
        assert_eq!(turned.as_flattened(), expected.as_flattened());
    }

    #[test]
    fn transform_is_that_of_the_kernel() {
        compare_transform::<8>(4e-7);
        compare_transform::<6>(2.4e-6);
    }

    /// `bound` is the width times the error of the taps.
    fn compare_transform<const TAPS: usize>(bound: f64) {
        let kernel = Kernel::<f64, TAPS>::new();
        let width = TAPS as f64;
        for xi in [0.0, 0.11, 0.25, 0.5] {
            // Applies the midpoint rule to the formula, over the width of the kernel.
            let n = 20_000;
            let sum: f64 = (0..n)
                .map(|i| {
                    let z = 2.0 * (f64::from(i) + 0.5) / f64::from(n) - 1.0;
                    let semicircle = (1.0 - z * z).sqrt();
                    libm::exp(BETA * width * (semicircle - 1.0)) * libm::cos(PI * xi * width * z)
                })
                .sum();
            let expected = width * sum / f64::from(n);
            assert!((kernel.transform(xi) - expected).abs() < bound, "{xi}");
        }
    }
}
