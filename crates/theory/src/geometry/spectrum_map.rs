//! What an affine step does to spectra.

use super::AffineMap;
use super::matrix::{Matrix, dot, plus, product, sections, times, transpose};
use etendue_field::{Complex, cis};
use std::f64::consts::TAU;

/// What a step does to spectra: L'(Ω) = factor · e^(−2πi Ω·phase) L(matrix · Ω).
///
/// A [`AffineMap`] has one, with factor |det A|, matrix Aᵀ and phase t. One that was printed
/// wrong need not be that of any map of rays, which is why it has a type of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpectrumMap<const N: usize> {
    /// What the spectrum is multiplied by.
    pub factor: f64,
    /// From the frequency after to the frequency before, as rows.
    pub matrix: Matrix<N>,
    /// The phase vector, in the units of the ray coordinates.
    pub phase: [f64; N],
}

impl<const N: usize> SpectrumMap<N> {
    /// This step, then `next`.
    #[must_use]
    pub fn then(&self, next: &Self) -> Self {
        Self {
            factor: self.factor * next.factor,
            matrix: product(&self.matrix, &next.matrix),
            phase: plus(&next.phase, &times(&transpose(&next.matrix), &self.phase)),
        }
    }

    /// What it does to rays, z' = A z + t: A is the transpose of its matrix, t its phase.
    #[must_use]
    pub fn rays(&self) -> AffineMap<N> {
        AffineMap {
            matrix: transpose(&self.matrix),
            offset: self.phase,
        }
    }

    /// The spectrum after the step at Ω of a field with the spectrum L before.
    #[must_use]
    pub fn spectrum(&self, omega: [f64; N], before: &dyn Fn([f64; N]) -> Complex) -> Complex {
        let turn = cis(-TAU * dot(&omega, &self.phase)) * self.factor;
        turn * before(times(&self.matrix, &omega))
    }
}

impl SpectrumMap<4> {
    /// The step that takes (Ωx, Ωu) by one step and (Ωy, Ωv) by another.
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
