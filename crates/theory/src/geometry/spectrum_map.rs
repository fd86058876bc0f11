//! The effect of an affine step on spectra.

use super::matrix::{Matrix, dot, plus, product, sections, times, transpose};
use etendue_field::{Complex, cis};
use std::f64::consts::TAU;

/// The effect of a step on spectra, which is L'(Ω) = factor · e^(−2πi Ω·phase) L(matrix · Ω).
///
/// Every [`AffineMap`](super::AffineMap) has a spectrum map with the factor |det A|, the matrix Aᵀ and the phase t.
/// The spectrum map is a separate type because a misprinted step may not correspond to any map of
/// rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpectrumMap<const N: usize> {
    /// The factor that multiplies the spectrum.
    pub factor: f64,
    /// The matrix, as rows. It maps the frequency after the step to the frequency before the step.
    pub matrix: Matrix<N>,
    /// The phase vector. Its components have the units of the ray coordinates.
    pub phase: [f64; N],
}

impl<const N: usize> SpectrumMap<N> {
    /// This step followed by `next`.
    #[must_use]
    pub fn then(&self, next: &Self) -> Self {
        Self {
            factor: self.factor * next.factor,
            matrix: product(&self.matrix, &next.matrix),
            phase: plus(&next.phase, &times(&transpose(&next.matrix), &self.phase)),
        }
    }

    /// The spectrum at Ω after the step, for a field with the spectrum L before it.
    #[must_use]
    pub fn spectrum(&self, omega: [f64; N], before: &dyn Fn([f64; N]) -> Complex) -> Complex {
        let turn = cis(-TAU * dot(&omega, &self.phase)) * self.factor;
        turn * before(times(&self.matrix, &omega))
    }
}

impl SpectrumMap<4> {
    /// The 4D step that applies the step `x` to (Ωx, Ωu) and the step `y` to (Ωy, Ωv).
    #[must_use]
    pub fn sections(x: &SpectrumMap<2>, y: &SpectrumMap<2>) -> Self {
        let [[x0, u0], [y0, v0]] = [x.phase, y.phase];
        Self {
            factor: x.factor * y.factor,
            matrix: sections(&x.matrix, &y.matrix),
            phase: [x0, y0, u0, v0],
        }
    }
}
