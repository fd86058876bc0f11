//! Every number of a compared plane, as in `summary.json`.

use crate::class::Class;
use crate::first_order::FirstOrderReport;
use crate::full_radial::FullRadialReport;
use crate::power::PowerReport;
use crate::score::ParameterReport;
use crate::verdict::Verdict;
use etendue_field::Frame;
use etendue_theory::geometry::Matrix;
use serde::Serialize;

/// Measured and predicted values of one number.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Pair {
    /// The value from the photons.
    pub measured: Option<f64>,
    /// The value of the prediction, by the same estimator.
    pub predicted: Option<f64>,
    /// Standard error of the difference. Where the prediction has replicates, this error combines
    /// the errors of the measured and of the predicted value. This error includes the possible error
    /// of the photons' transform and, for a shear slope, that of the prediction's quadrature.
    pub error: Option<f64>,
}

/// Measured and predicted values of one number, each in the azimuth where it is largest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DirectedPair {
    /// The value from the photons.
    pub measured: Option<f64>,
    /// The value of the prediction, by the same estimator.
    pub predicted: Option<f64>,
    /// Standard error of the difference, with the possible error of the photons' transform.
    pub error: Option<f64>,
    /// The azimuths of the two values.
    pub azimuth: Azimuths,
}

/// Azimuths of a measured and a predicted number, radians from X towards Y.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Azimuths {
    /// The azimuth of the measured number.
    pub measured: Option<f64>,
    /// The azimuth of the predicted number.
    pub predicted: Option<f64>,
}

/// The bandwidths along both axes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bandwidth {
    /// The bandwidth along ρ, cycles per metre.
    pub rho: DirectedPair,
    /// The bandwidth along ν, cycles per unit slope.
    pub nu: DirectedPair,
}

/// Second central moments of a windowed light field, [4, 4], in the units of the coordinates.
///
/// The moments are finite because the window is bounded. Second moments of the spectrum may be
/// infinite: if the field has an edge, they grow with the frequency grid. Therefore the bandwidth
/// is defined as a percentile.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Covariance {
    /// The moments of the photons.
    pub measured: Matrix<4>,
    /// Standard errors of `measured`, by the jackknife.
    pub error: Matrix<4>,
    /// If the prediction consists of rays that are traced through the real geometry, the moments of
    /// these rays.
    pub predicted: Option<Matrix<4>>,
    /// The moments A S Aᵀ of a Gaussian that starts as wide as the light. The first-order chain
    /// propagates them through a Gaussian window. Masks are left out.
    pub propagated: Option<Matrix<4>>,
}

/// The share of energy above a cut in the spectrum of the windowed irradiance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HighFrequencyShare {
    /// The cut, cycles per metre.
    pub cut: f64,
    /// H, the share of energy above the cut.
    pub share: Pair,
}

/// The share of power in the wedge that blockers between two distances fill.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct WedgeShare {
    /// Shortest distance from the plane, metres.
    pub nearest: f64,
    /// Longest distance, metres.
    pub farthest: f64,
    /// The share of the power of the radial spectrum. The main lobe of the window about zero is
    /// left out.
    pub share: Pair,
}

/// All results of one plane, as in `summary.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlaneReport {
    /// Name of the plane.
    pub name: String,
    /// Kind of prediction.
    pub class: Class,
    /// The chain, with one line for each step.
    pub chain: Vec<String>,
    /// Estimated ‖error‖/‖F‖ of a prediction that is not in closed form. Where the prediction has
    /// replicates, this error is their standard error, which is also included in the noise.
    pub quadrature_error: Option<f64>,
    /// The plane's frame, world coordinates.
    pub frame: Frame,
    /// Distance from the light along the central ray, metres.
    pub distance: f64,
    /// Photons that crossed the plane.
    pub crossed: u64,
    /// Photons that crossed the plane inside the window.
    pub in_window: u64,
    /// Photons that crossed the plane outside the window.
    pub outside_window: u64,
    /// ‖S − F‖/‖F‖ over the independent frequencies.
    pub relative_error: Option<f64>,
    /// √Σσ²/‖F‖: the relative error that noise alone would cause.
    pub noise_limit: Option<f64>,
    /// Signed root of relative error² − noise limit²: the disagreement beyond noise.
    pub excess: Option<f64>,
    /// Standard error of the square of `excess` if the prediction is true.
    pub excess_squared_error: Option<f64>,
    /// 10 log₁₀ of the ratio of the mean σ² to the largest |F|².
    pub noise_floor_db: Option<f64>,
    /// The effective number of independent real numbers in the noise of the measured slices, for a
    /// test of two results ([`crate::noise_dof`]); `None` without noise.
    pub noise_dof: Option<f64>,
    /// Mean of |S − F|²/σ². It is corrected for the bias that arises because σ² is an estimate.
    pub chi2_per_dof: Option<f64>,
    /// Probability of a disagreement of the slices at least this large if the prediction is true.
    pub p_value: Option<f64>,
    /// The comparison of the radial spectrum; `None` if a batch has no photons. The plane passes
    /// only if this p-value and the p-value of the slices pass.
    pub radial: Option<PowerReport>,
    /// The score test of each parameter of the chain.
    pub parameters: Vec<ParameterReport>,
    /// Shear slope of the radial spectrum, metres.
    pub slope: Pair,
    /// Second moments of the radial spectrum over the grid: ρρ, ρν and νν. For a field with edges
    /// the moments grow with the grid, and the bandwidth is the better measure.
    pub spectral_moments: [Pair; 3],
    /// 95 % bandwidths of the slices where they are largest.
    pub bandwidth_95: Bandwidth,
    /// 95 % bandwidths of the light after its mean is subtracted. They show how fast the light
    /// changes.
    pub variation_95: Bandwidth,
    /// Second central moments of the windowed light field over the coordinates of the plane. The
    /// moments are `None` where no light arrived.
    pub covariance: Option<Covariance>,
    /// The share H at two cuts, for a plane where light leaves a diffuse surface. The list is empty
    /// for any other plane.
    pub high_frequency_share: Vec<HighFrequencyShare>,
    /// The shares of power in two wedges, if blockers stand on the way to a plane of the first leg.
    /// The first wedge lies between the nearest and the farthest blocker. The second wedge reaches
    /// back to the light, because the light has edges too. The list is empty for any other plane.
    pub wedge_share: Vec<WedgeShare>,
    /// The full radial spectrum, where the light field was put on a 4D grid (`--save field`).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub full_radial: Option<FullRadialReport>,
    /// The comparison of the photons with the first-order chain, if the plane has such a chain. All
    /// numbers above compare the photons with the exact ray-space prediction.
    pub first_order: Option<FirstOrderReport>,
    /// The verdict.
    pub verdict: Verdict,
    /// The reason why an undecided plane is undecided, in words.
    pub undecided: Option<String>,
    /// Number of photons that would decide an undecided plane. The number is `None` where it is not
    /// known, or where more photons do not help.
    pub photons_needed: Option<f64>,
    /// Limits of the measurement, in words.
    pub warnings: Vec<String>,
}

impl PlaneReport {
    /// The verdict on the exact prediction. This verdict does not depend on the verdict on
    /// a first-order chain.
    #[must_use]
    pub fn exact_verdict(&self) -> Verdict {
        let chain = self.first_order.as_ref();
        chain.map_or(self.verdict, |chain| chain.exact)
    }
}
