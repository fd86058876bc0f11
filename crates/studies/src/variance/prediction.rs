//! The variance of a mean over N points, predicted from the power of the field.

use crate::variance::power_estimate::{PowerEstimate, jackknife_error};
use crate::variance::radiance::WindowMoments;
use crate::variance::response::SamplerResponse;
use etendue_spectrum::Uncertain;

/// The largest share of the tail in the prediction for a fixed set of points. Beyond it, the
/// prediction is undecided, because a fixed set has peaks beyond the box.
pub const MAX_FILE_TAIL: f64 = 0.2;

/// The predicted variance of the mean of the radiance at N points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PredictedVariance {
    /// The variance and its standard error, from the jackknife over groups of photons, from the
    /// error of σ² and from the error of the noise of radiances. The unit is the square of the unit
    /// of radiance.
    pub variance: Uncertain,
    /// The share of the tail beyond the measured parts in the variance.
    pub tail: f64,
}

impl PredictedVariance {
    /// Σ_(m≠0) |f_m|² E|S_m|², where the power beyond the measured parts is the dyadic tail.
    /// The power and the response are both at frequencies, for sets that are shifted on the torus at
    /// random, or both in dyadic bands, for sets that are not shifted. `count` is N, by which the
    /// noise of radiances is divided.
    ///
    /// The tail follows the power of edges. The error of this assumption is not part of the stated
    /// error.
    #[must_use]
    pub fn new(
        power: &PowerEstimate,
        response: &SamplerResponse,
        moments: &WindowMoments,
        count: usize,
    ) -> Self {
        let is_known = power.has_last_octave();
        let of_tail = |parts: &[f64]| {
            if is_known {
                dot(parts, &response.tail) / power.last_octave(parts)
            } else {
                1.0 / count as f64
            }
        };
        let missing = |power: &[f64]| moments.variance.value - power.iter().sum::<f64>();
        let (value, without) =
            power.estimates(|power| dot(power, &response.inside) + missing(power) * of_tail(power));
        let noise = 1.0 / count as f64;
        let errors = [
            jackknife_error(&without),
            of_tail(&power.power) * moments.variance.error,
            noise * moments.noise.error,
        ];
        let value = value + noise * moments.noise.value;
        Self {
            variance: Uncertain {
                value,
                error: errors.iter().map(|e| e * e).sum::<f64>().sqrt(),
            },
            tail: missing(&power.power) * of_tail(&power.power) / value,
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
