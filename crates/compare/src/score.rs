//! Estimates the parameters of a prediction from the photons.

use crate::normal::{NormalEquations, weighted};
use crate::prediction::PredictedParameter;
use crate::residuals::Residuals;
use ndarray::Array3;
use serde::Serialize;
use std::slice;

/// One parameter of the chain, with its value in the scene and its value as measured by the
/// photons.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParameterReport {
    /// Name of the parameter, such as "travel light to blockers".
    pub name: String,
    /// Unit of the values, empty for a pure number.
    pub unit: String,
    /// Value in the scene.
    pub scene: f64,
    /// Measured value. The estimate assumes that all other parameters have their values in the
    /// scene.
    pub measured: f64,
    /// Standard error of the measured value, including the error of the prediction.
    pub error: f64,
    /// The smallest change that is detected at level 1 % nine times in ten. This change is 3.86
    /// standard errors.
    pub detectable: f64,
}

/// A two-sided test at level 1 % detects a change of this many standard errors with power 90 %. It
/// is the sum of the normal quantiles 2.576 and 1.282.
const DETECTABLE: f64 = 3.858;

/// The score test of one parameter (docs/theory.md, section 6). The test projects S − F on
/// ∂F/∂parameter, weighted by 1/σ².
///
/// With D = ∂F/∂parameter, the step δ = Re Σ conj(D)(S − F)/σ² / Σ|D|²/σ² is the least-squares
/// change of the parameter. The error of δ is computed from the spread of δ over the residuals.
/// This error includes correlations between frequencies and the noise of a prediction's replicates.
/// A numerical error of the prediction, `numerical` = ‖error‖, changes δ by at most `numerical`
/// ‖D/σ²‖ / Σ|D|²/σ² (Cauchy–Schwarz). The squares of this bound and of the standard error are
/// added. The step and its error are correct to first order in δ.
///
/// Returns `None` if the prediction does not depend on the parameter, or if no photon arrived.
#[must_use]
pub fn score(
    residuals: &Residuals,
    variance: &Array3<f64>,
    parameter: &PredictedParameter,
    numerical: f64,
) -> Option<ParameterReport> {
    let derivative = &parameter.derivative.half;
    let equations = NormalEquations::new(residuals, variance, slice::from_ref(derivative));
    let information = equations.information[[0, 0]];
    if information <= 0.0 {
        return None;
    }
    let steps = equations.steps()?;
    let count = steps.len() as f64;
    let step = steps.iter().sum::<f64>() / count;
    let spread: f64 = steps.iter().map(|s| (s - step).powi(2)).sum();
    let noise = (spread / (count * (count - 1.0))).sqrt();
    let weighted = weighted(derivative, variance);
    let weight = residuals
        .sum(&weighted, variance, |w, _| w.norm_sqr())
        .sqrt();
    let error = libm::hypot(noise, numerical * weight / information);
    Some(ParameterReport {
        name: parameter.name.clone(),
        unit: parameter.unit.clone(),
        scene: parameter.value,
        measured: parameter.value + step,
        error,
        detectable: DETECTABLE * error,
    })
}
