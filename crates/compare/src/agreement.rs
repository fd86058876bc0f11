//! How far measured and predicted are apart, and what that means.

use crate::prediction::Prediction;
use crate::residuals::Residuals;
use crate::verdict::Verdict;
use etendue_field::{PlaneTally, Slices};
use ndarray::Array3;

/// The largest noise, as a share of the spectrum, with which agreement means something.
const RESOLVED: f64 = 0.5;

/// The largest error of a quadrature, as a share of the noise, with which agreement means
/// something. It is an upper estimate, and adds a quarter to χ² at the most.
const BLURRED: f64 = 0.5;

/// The largest error of a quadrature that cannot be seen, as a share of the noise: it adds a
/// thousandth to χ², and goes without a warning.
pub(crate) const UNSEEN: f64 = 1.0 / 30.0;

/// How far measured and predicted are apart, over the independent frequencies.
pub(crate) struct Agreement {
    /// Σ|S − F|².
    difference: f64,
    /// Σσ².
    noise: f64,
    /// Σ|F|².
    predicted: f64,
    /// The standard error of the square of the excess if the prediction is true.
    pub(crate) excess_squared_error: Option<f64>,
    /// 10 log₁₀ of the mean σ² over the largest |F|².
    pub(crate) noise_floor_db: Option<f64>,
}

impl Agreement {
    pub(crate) fn new(residuals: &Residuals, variance: &Array3<f64>, prediction: &Slices) -> Self {
        let half = &prediction.half;
        let predicted = residuals.sum(half, variance, |f, _| f.norm_sqr());
        let noise = residuals.sum(half, variance, |_, v| *v);
        let difference = residuals.sum(&residuals.mean(), variance, |m, _| m.norm_sqr());
        let peak = half.iter().map(|f| f.norm_sqr()).fold(0.0, f64::max);
        let mean_noise = noise / residuals.frequencies() as f64;
        Self {
            difference,
            noise,
            predicted,
            excess_squared_error: (predicted > 0.0).then(|| residuals.squared_error() / predicted),
            noise_floor_db: (peak > 0.0 && noise > 0.0).then(|| 10.0 * (mean_noise / peak).log10()),
        }
    }

    /// The signed root of a square, as a share of the prediction.
    fn relative(&self, squared: f64) -> Option<f64> {
        (self.predicted > 0.0).then(|| (squared.abs() / self.predicted).sqrt().copysign(squared))
    }

    pub(crate) fn relative_error(&self) -> Option<f64> {
        self.relative(self.difference)
    }

    pub(crate) fn noise_limit(&self) -> Option<f64> {
        self.relative(self.noise)
    }

    pub(crate) fn excess(&self) -> Option<f64> {
        self.relative(self.difference - self.noise)
    }

    /// What p comes to. With noise above half of the spectrum batches hold a handful of photons,
    /// and their residuals are not symmetric: nothing is decided then.
    pub(crate) fn verdict(&self, agrees: bool) -> Verdict {
        if self.noise_limit().is_some_and(|noise| noise > RESOLVED) {
            Verdict::Undecided
        } else if agrees {
            Verdict::Pass
        } else {
            Verdict::Fail
        }
    }

    /// Whether the error of a prediction without replicates leaves nothing to be decided:
    /// agreement, if the error is not below the noise, or disagreement, if the error may be all of
    /// it.
    pub(crate) fn is_blurred(&self, prediction: &Prediction, agrees: bool) -> bool {
        let error = prediction.systematic_error();
        let (Some(error), Some(noise), Some(excess)) = (error, self.noise_limit(), self.excess())
        else {
            return false;
        };
        if agrees {
            error > BLURRED * noise
        } else {
            error > excess.max(UNSEEN * noise)
        }
    }

    /// Photons that bring the noise to where agreement means something; `None` where the
    /// statistical error of the prediction alone is above that.
    pub(crate) fn photons_needed(&self, emitted: u64, prediction: &Prediction) -> Option<f64> {
        let noise = self.noise_limit().unwrap_or_default().powi(2);
        let stays = prediction.statistical_error().unwrap_or(0.0).powi(2);
        let allowed = RESOLVED * RESOLVED - stays;
        let falls = (noise - stays).max(0.0);
        (allowed > 0.0).then(|| (emitted as f64 * falls / allowed).ceil())
    }
}

/// Whether p reaches the level; of a dark prediction, whether not a single photon came.
pub(crate) fn agrees(
    predicted: &Slices,
    tally: &PlaneTally,
    p_value: Option<f64>,
    level: f64,
) -> bool {
    let dark = predicted.half.iter().all(|f| f.norm_sqr() <= 0.0);
    if dark {
        tally.inside == 0
    } else {
        p_value.is_some_and(|p| p >= level)
    }
}
