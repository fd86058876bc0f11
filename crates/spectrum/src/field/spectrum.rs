//! Defines the spectrum of a windowed light field on a 4D grid.

use super::spline::worst_alias;
use etendue_field::{Assignment, Complex, FieldGrid};
use ndarray::Array4;

/// The spectrum of a windowed light field, computed on a 4D grid. Apart from aliasing, the spectrum
/// is Σ w e^(−2πi Ω·z) over the rays.
///
/// Phases refer to the plane's origin, and the spectrum is divided by the transform of the spline.
/// Therefore a ray contributes w e^(−2πi Ω·z) (1 + ε) at each frequency. The unit is the unit of ∫
/// L W dx dy du dv, as for [`Slices`](etendue_field::Slices).
#[derive(Clone, Debug, PartialEq)]
pub struct FieldSpectrum {
    /// The grid, which determines the frequencies.
    pub grid: FieldGrid,
    /// The method that assigned rays to the cells of the grid.
    pub assignment: Assignment,
    /// The values [x, y, u, v], with frequencies in the order of [`FieldGrid::harmonic`]. The field
    /// is real, so frequencies along v run only from zero to Nyquist.
    pub values: Array4<Complex>,
}

impl FieldSpectrum {
    /// The value at the given multiples of the frequency spacings; each multiple is at
    /// most n/2 in modulus.
    ///
    /// At a Nyquist frequency, +n/2 and −n/2 have the same value, which is not an estimate of the
    /// spectrum.
    ///
    /// # Panics
    ///
    /// Panics if a multiple is beyond Nyquist.
    #[must_use]
    pub fn at(&self, harmonics: [isize; 4]) -> Complex {
        if harmonics[3] < 0 {
            return self.at(harmonics.map(|h| -h)).conj();
        }
        let index = |axis: usize| {
            let n = self.grid.cells[axis];
            let modulus = harmonics[axis].unsigned_abs();
            assert!(
                2 * modulus <= n,
                "{harmonics:?} is beyond the Nyquist frequency"
            );
            if harmonics[axis] < 0 {
                n - modulus
            } else {
                modulus
            }
        };
        self.values[[index(0), index(1), index(2), index(3)]]
    }

    /// Returns ℓ̂(0) = ∫ L W.
    #[must_use]
    pub fn at_zero(&self) -> f64 {
        self.values[[0; 4]].re
    }

    /// A bound on the difference between [`at`](Self::at) and the exact sum over the same
    /// rays, if no weight is negative. The bound is Σw (Π(1 + ε_d) − 1), where ε_d is the largest
    /// alias of a ray along axis d.
    ///
    /// The bound is rigorous for any field. For assignments of order 1 and 2, the bound is reached
    /// if all light is in one ray at the position with the largest alias. The bound grows as the
    /// frequency to the power p, where p is the order of the spline, so it is almost useless near
    /// Nyquist.
    #[must_use]
    pub fn alias_bound(&self, harmonics: [isize; 4]) -> f64 {
        let worst = |axis: usize| {
            let f = harmonics[axis] as f64 / self.grid.cells[axis] as f64;
            worst_alias(self.assignment, f)
        };
        // Computes Π(1 + ε) − 1 in a form that does not lose small ε to rounding.
        let sum = (0..4).fold(0.0, |sum, axis| sum + worst(axis) * (1.0 + sum));
        self.at_zero() * sum
    }
}
