//! The prediction of a light field.

use crate::geometry::Matrix;
use etendue_field::{Complex, Projection, Slices};

/// The mean of sums over independent nets.
#[derive(Clone, Debug, PartialEq)]
pub struct NetMean {
    /// The mean.
    pub slices: Slices,
    /// ‖σ‖/‖F‖ with the standard error σ of the mean F.
    pub error: f64,
}

impl NetMean {
    /// The largest share of noise in the power of a derivative from which a parameter is measured.
    const MAX_NOISE: f64 = 0.5;

    /// A derivative of the length that it would have without noise: D (1 − ‖σ‖²/‖D‖²).
    ///
    /// A measured change of a parameter is ⟨D, r⟩/⟨D, D⟩ with the residual r, and noise makes ⟨D, D⟩
    /// too large. Without this factor, the change and its error would be too small by as much. The
    /// derivative is zero, so that the parameter is not determined, if most of it is noise.
    pub(crate) fn without_noise(self) -> Slices {
        let noise = self.error * self.error;
        let mut slices = self.slices;
        if noise > Self::MAX_NOISE {
            return Slices::zeros(slices.grid);
        }
        slices.half *= Complex::from(1.0 - noise);
        slices
    }
}

/// The prediction of a light field.
#[derive(Clone, Debug, PartialEq)]
pub struct Predicted {
    /// The slices of the windowed spectrum. The unit is W m⁻² sr⁻¹ · m²; on a surface, the unit is
    /// W m⁻² sr⁻¹ · m² rad².
    pub slices: Slices,
    /// Independent unbiased predictions. Their mean is `slices`. The list is empty for closed forms
    /// and quadrature rules.
    pub replicates: Vec<Slices>,
    /// The relative error ‖error‖/‖F‖. For replicates, the error is the standard error of their
    /// mean. For quadrature rules, the error is the change under finer rules. The error is `None`
    /// for a closed form, and infinite if no ray arrives.
    pub error: Option<f64>,
    /// The integral ∫ L W of the light without occluders. This is the scale for errors of a closed
    /// form. For nets, the value is zero.
    pub unblocked: f64,
    /// The windowed light field integrated over y and v, as means over cells of (x, u).
    pub projection: Projection,
    /// Second central moments of the windowed light field, in the plane's coordinates. The value is
    /// `None` for closed forms, or if no light arrives.
    pub covariance: Option<Matrix<4>>,
    /// The derivatives of the slices with respect to each of the requested parameters, per unit of
    /// the parameter.
    pub derivatives: Vec<Slices>,
    /// The prediction of the first-order chain of a reflection minus `slices`, computed with the
    /// same rays.
    pub to_first_order: Option<NetMean>,
    /// The number of rays that were followed for the slices, or for the picture if the slices are
    /// not a sum over nets; zero for closed forms.
    pub nodes: f64,
}

impl Predicted {
    /// A prediction without an error, moments or derivatives, which is no sum over nets.
    pub(crate) fn exact(slices: Slices, projection: Projection) -> Self {
        Self {
            slices,
            replicates: Vec::new(),
            error: None,
            unblocked: 0.0,
            projection,
            covariance: None,
            derivatives: Vec::new(),
            to_first_order: None,
            nodes: 0.0,
        }
    }

    /// This prediction minus another one from the same nets, as a mean over the nets.
    /// Returns `None` if a prediction is no sum over nets.
    #[must_use]
    pub fn minus(&self, other: &Self) -> Option<NetMean> {
        let both = [self, other].map(|one| &one.replicates);
        if both.iter().any(|replicates| replicates.is_empty()) {
            return None;
        }
        let pairs = both[0].iter().zip(both[1]);
        let apart = pairs.map(|(a, b)| Slices {
            half: &a.half - &b.half,
            ..*a
        });
        let apart: Vec<Slices> = apart.collect();
        Some(NetMean::new(apart.iter()))
    }
}
