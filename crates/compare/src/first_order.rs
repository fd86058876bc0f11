//! Adds the paper's linearised chain to the exact ray-space prediction.

use crate::residuals::Residuals;
use crate::verdict::Verdict;
use etendue_field::Slices;
use etendue_spectrum::Measurement;
use etendue_theory::geometry::Matrix;
use serde::{Deserialize, Serialize};

/// The prediction of the chain of affine maps.
#[derive(Clone, Debug)]
pub struct FirstOrder {
    /// The slices of the chain. They follow the paper's printed formulas where a scene asks for
    /// these formulas.
    pub slices: Slices,
    /// Independent replicates; `slices` is their mean. The list is empty where the slices have no
    /// statistical error.
    pub replicates: Vec<Slices>,
    /// The numbers that describe the chain.
    pub chain: FirstOrderChain,
}

/// The numbers that describe a chain of affine maps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FirstOrderChain {
    /// ‖first order − exact‖/‖exact‖ as computed, by the corrected formulas.
    pub error: f64,
    /// The error that remains as the neighbourhood of the central ray shrinks. The defect is zero,
    /// apart from rounding errors, if every map is right (see [`defect`](etendue_theory::path::rays::defect)). Where `slices`
    /// come from the printed formulas, the defect is also the defect of the printed formulas.
    pub defect: f64,
    /// The relative error of the radiance that the chain assigns to the central ray. This error is
    /// the part of the defect that is due to the constant factor of the chain.
    #[serde(default)]
    pub radiance_defect: f64,
    /// The matrix A in z' = A z, which takes rays from the light to the plane. It follows the
    /// corrected formulas.
    pub matrix: Matrix<4>,
    /// The covariance of the windowed light field as computed from rays, and as propagated by the
    /// chain (see [`Covariance`](crate::Covariance)).
    pub covariance: [Option<Matrix<4>>; 2],
    /// The distances, in metres, from the last surface to the foci. A focus is a point where rays
    /// that leave the light in parallel meet.
    pub foci: Vec<f64>,
    /// Whether `slices` come from the paper's printed formulas.
    pub as_printed: bool,
}

/// The comparison of the photons with the first-order chain, as in `summary.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FirstOrderReport {
    /// The numbers that describe the chain.
    #[serde(flatten)]
    pub chain: FirstOrderChain,
    /// Signed root of (‖S − F₁‖² − noise)/‖exact‖²: the disagreement of the chain beyond noise.
    pub excess: Option<f64>,
    /// The upper 95 % bound of the excess.
    pub excess_bound: Option<f64>,
    /// The smallest excess that can be detected above this noise, at 95 %.
    pub resolvable: Option<f64>,
    /// Probability of a disagreement at least this large if the first-order chain were true.
    pub p_value: Option<f64>,
    /// The verdict on the exact prediction by rays that accompanies the chain.
    pub exact: Verdict,
    /// The verdict on the chain.
    pub verdict: Verdict,
}

/// If the defect exceeds this limit, a map of the chain is wrong. Finite differences alone cause a
/// defect of 10⁻⁹. If a first-order operator is missing or wrong by a thousandth, the defect
/// exceeds this limit.
const DEFECT: f64 = 1e-5;
/// If its error exceeds this limit, a first-order chain is useless as a prediction of the light
/// field.
const MAX_ERROR: f64 = 0.5;
/// The one-sided 95 % quantile of the normal distribution.
const NINETY_FIVE: f64 = 1.645;

impl FirstOrderChain {
    /// The verdict on the chain. The chain fails if a map is wrong, and is undecided if its
    /// error is too large for a useful prediction.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        if self.defect > DEFECT {
            Verdict::Fail
        } else if self.error > MAX_ERROR {
            Verdict::Undecided
        } else {
            Verdict::Pass
        }
    }
}

impl FirstOrderReport {
    /// The square of `excess`, with the sign of `excess`, and the standard error of this
    /// square.
    #[must_use]
    pub fn squared_excess(&self) -> Option<[f64; 2]> {
        let [square, high] = [self.excess?, self.excess_bound?].map(|root| root * root.abs());
        Some([square, (high - square) / NINETY_FIVE])
    }
}

impl FirstOrder {
    /// Compares a measurement with the chain. `exact` holds the exact ray-space prediction and the
    /// differences between the photons and this prediction.
    pub(crate) fn report(
        &self,
        measurement: &Measurement,
        index: usize,
        (slices, exact, verdict): (&Slices, &Residuals, Verdict),
        seed: u64,
    ) -> FirstOrderReport {
        let residuals = Residuals::between(measurement, index, &self.slices, &self.replicates);
        let half = &slices.half;
        let predicted = residuals.sum(half, half, |f, _| f.norm_sqr());
        let (squared, error) = residuals.squared();
        let high = squared + NINETY_FIVE * error;
        let root = |x: f64| {
            let relative = x / predicted;
            (predicted > 0.0).then(|| relative.abs().sqrt().copysign(relative))
        };
        FirstOrderReport {
            chain: self.chain.clone(),
            excess: root(squared),
            excess_bound: root(high),
            resolvable: root(NINETY_FIVE * exact.squared_error()),
            p_value: residuals.p_value(seed),
            exact: verdict,
            verdict: self.chain.verdict(),
        }
    }
}
