//! The geometric operators as Durand et al. 2005 print them.

use super::{AffineMap, Matrix, SpectrumMap};
use std::f64::consts::TAU;

/// The version of the geometric operators (docs/theory.md, section 7).
///
/// The steps onto and off a surface in Durand et al. 2005 differ from ray geometry, and the
/// paper's equations differ from its Table 1. The paper prints the mirror and travel steps
/// correctly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edition {
    /// The formulas that follow from ray geometry, which are the maps of [`geometry`](super).
    Corrected,
    /// The operators in the paper's Eqs. 9, 11 and 10. For a surface in 3D, the shear by M is taken
    /// from the text after Eq. 19.
    Equations,
    /// The operators in the paper's Table 1: light incidence, curvature and outgoing angle. The
    /// table has no row for 3D, so the shear by M is given the sign of the table's curvature.
    Table,
}

impl Edition {
    /// The step of light incidence. Eq. 9: e^(−iΩθ θ₀) c₀ L(−c₀ Ωx, Ωθ); Table 1: e^(−iΩθ
    /// θ₀)/c₀ L(−c₀ Ωx, Ωθ).
    #[must_use]
    pub fn incidence(self, theta0: f64) -> SpectrumMap<2> {
        let right = AffineMap::<2>::incidence(theta0).spectrum_map();
        let c0 = libm::cos(theta0);
        let factor = match self {
            Self::Corrected => return right,
            Self::Equations => c0,
            Self::Table => 1.0 / c0,
        };
        SpectrumMap {
            factor,
            matrix: [[-c0, 0.0], [0.0, 1.0]],
            phase: without_two_pi(right.phase),
        }
    }

    /// The step of the outgoing angle. Eq. 10 and Table 1: e^(iΩθ θ₁) c₁ L(Ωx/c₁, Ωθ).
    #[must_use]
    pub fn outgoing(self, theta1: f64) -> SpectrumMap<2> {
        let right = AffineMap::<2>::outgoing(theta1).spectrum_map();
        match self {
            Self::Corrected => right,
            Self::Equations | Self::Table => SpectrumMap {
                factor: right.factor,
                matrix: [[1.0 / libm::cos(theta1), 0.0], [0.0, 1.0]],
                phase: without_two_pi(right.phase),
            },
        }
    }

    /// The step of light incidence in 4D, where (x, θ) change as in 2D. The paper does not
    /// mention that the latitude changes its sign; this function includes the change of sign for
    /// every edition.
    #[must_use]
    pub fn incidence_4d(self, theta0: f64) -> SpectrumMap<4> {
        SpectrumMap::sections(&self.incidence(theta0), &AffineMap::mirror().spectrum_map())
    }

    /// The step of curvature in 4D. In the text after Eq. 19, this step is a shear by M
    /// without the cosine.
    #[must_use]
    pub fn curvature_4d(self, shape: Matrix<2>, theta0: f64) -> SpectrumMap<4> {
        AffineMap::<4>::curvature(self.signed(shape), self.longitude(theta0)).spectrum_map()
    }

    /// The step back from the frames of the local normals in 4D.
    #[must_use]
    pub fn back_4d(self, shape: Matrix<2>, theta1: f64) -> SpectrumMap<4> {
        AffineMap::<4>::back(self.signed(shape), self.longitude(theta1)).spectrum_map()
    }

    /// The step of the outgoing angle in 4D, where (x, θ) change as in 2D.
    #[must_use]
    pub fn outgoing_4d(self, theta1: f64) -> SpectrumMap<4> {
        SpectrumMap::sections(
            &self.outgoing(theta1),
            &AffineMap::identity().spectrum_map(),
        )
    }

    /// The sign of the shear by curvature relative to the sign from ray geometry: −1 for
    /// Eq. 11, which has the opposite sign, and 1 otherwise.
    pub(super) fn sign(self) -> f64 {
        match self {
            Self::Corrected | Self::Table => 1.0,
            Self::Equations => -1.0,
        }
    }

    fn signed(self, shape: Matrix<2>) -> Matrix<2> {
        shape.map(|row| row.map(|entry| self.sign() * entry))
    }

    /// The longitude whose cosine multiplies M. The text after Eq. 19 omits the cosine, so
    /// its longitude is 0.
    fn longitude(self, theta: f64) -> f64 {
        match self {
            Self::Corrected => theta,
            Self::Equations | Self::Table => 0.0,
        }
    }
}

/// The phase vector for which e^(−2πi Ω·t) equals the printed e^(−iΩ·t).
fn without_two_pi(phase: [f64; 2]) -> [f64; 2] {
    phase.map(|t| t / TAU)
}
