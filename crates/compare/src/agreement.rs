//! Measures the difference between a measurement and its prediction, and decides what the
//! difference means.

use crate::prediction::Prediction;
use crate::residuals::Residuals;
use crate::verdict::Test;
use etendue_field::Slices;
use ndarray::Array3;

/// The largest quadrature error that is ignored, as a share of the noise. An error of this size
/// adds a thousandth to χ² and causes no warning.
pub(crate) const UNSEEN: f64 = 1.0 / 30.0;

/// The difference of measurement and prediction, summed over the independent frequencies.
pub(crate) struct Agreement {
    /// Σ|S − F|².
    difference: f64,
    /// Σσ².
    noise: f64,
    /// Σ|F|².
    predicted: f64,
    /// The power Σ|S|² of the measurement without its noise.
    measured: f64,
    /// The standard error of the square of the excess if the prediction is true.
    pub(crate) excess_squared_error: Option<f64>,
    /// 10 log₁₀ of the ratio of the mean σ² to the largest |F|².
    pub(crate) noise_floor_db: Option<f64>,
}

impl Agreement {
    pub(crate) fn new(residuals: &Residuals, variance: &Array3<f64>, prediction: &Slices) -> Self {
        let half = &prediction.half;
        let mean = residuals.mean();
        let predicted = residuals.sum(half, variance, |f, _| f.norm_sqr());
        let noise = residuals.sum(half, variance, |_, v| *v);
        let difference = residuals.sum(&mean, variance, |m, _| m.norm_sqr());
        let peak = half.iter().map(|f| f.norm_sqr()).fold(0.0, f64::max);
        let mean_noise = noise / residuals.frequencies() as f64;
        Self {
            difference,
            noise,
            predicted,
            measured: residuals.sum(&mean, half, |m, f| (m + f).norm_sqr()) - noise,
            excess_squared_error: (predicted > 0.0).then(|| residuals.squared_error() / predicted),
            noise_floor_db: (peak > 0.0 && noise > 0.0)
                .then(|| 10.0 * libm::log10(mean_noise / peak)),
        }
    }

    /// Returns √|q| with the sign of the squared quantity q, divided by the norm of the prediction.
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

    /// The noise relative to the larger of the measured and predicted spectra.
    pub(crate) fn resolution(&self) -> f64 {
        (self.noise / self.predicted.max(self.measured)).sqrt()
    }

    /// Checks whether the systematic error of a prediction may explain the whole disagreement with
    /// the photons.
    pub(crate) fn is_explained(&self, prediction: &Prediction) -> bool {
        let error = prediction.systematic_error();
        let (Some(error), Some(noise), Some(excess)) = (error, self.noise_limit(), self.excess())
        else {
            return false;
        };
        error > excess.max(UNSEEN * noise)
    }

    /// The number of photons at which the noise would equal the resolution. Returns `None`
    /// if the error of the prediction exceeds the resolution by itself, or if the noise is low
    /// enough for a verdict.
    pub(crate) fn photons_needed(
        &self,
        emitted: u64,
        prediction: &Prediction,
        test: &Test,
    ) -> Option<f64> {
        let noise = self.resolution().powi(2);
        let stays = prediction.statistical_error().unwrap_or(0.0).powi(2);
        let allowed = test.resolution.powi(2) - stays;
        let falls = (noise - stays).max(0.0);
        (allowed > 0.0 && falls > allowed).then(|| (emitted as f64 * falls / allowed).ceil())
    }
}
