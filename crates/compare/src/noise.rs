//! Estimates how many independent numbers the noise of measured slices contains.

use crate::residuals::Residuals;
use etendue_spectrum::Measurement;
use etendue_spectrum::estimate::{self, TooFewBatches};

/// The effective number n of independent real numbers in the noise of plane `plane`. If the
/// noise at each frequency is divided by its σ, the mean square of the noise fluctuates as much as
/// the mean square of n normal numbers.
///
/// The window correlates neighbouring frequencies. If C is the covariance of the noise divided by
/// σ, the mean of |S − E S|²/σ² over m frequencies has the variance 2 tr C²/m². The mean square of
/// (tr C)²/tr C² independent numbers has the same relative variance (Satterthwaite 1946). The
/// batches give the sample covariance Ĉ of n = R − 1 degrees of freedom. The expression n²/((n −
/// 1)(n + 2)) · (tr Ĉ² − (tr Ĉ)²/n) is an unbiased estimate of tr C² for normal noise (Srivastava
/// 2005, Eq. 2.4).
///
/// Returns `None` if there is no noise.
///
/// # Errors
/// Returns an error for fewer than three batches.
pub fn noise_dof(measurement: &Measurement, plane: usize) -> Result<Option<f64>, TooFewBatches> {
    let batches = measurement.batches().len();
    if batches < 3 {
        let have = batches;
        return Err(TooFewBatches { have, need: 3 });
    }
    let mean = estimate::slices(measurement, plane)?.mean;
    Ok(Residuals::new(measurement, plane, &mean).noise_dof())
}

impl Residuals {
    /// The effective number of independent real numbers in the noise ([`noise_dof`]). Each residual
    /// must be the difference between a batch and the mean.
    #[must_use]
    pub fn noise_dof(&self) -> Option<f64> {
        // tr Ĉ and tr Ĉ² are computed from the matrix of products, which has the same non-zero
        // eigenvalues as Ĉ.
        let products = self.products(true);
        let trace = products.diag().sum();
        if trace <= 0.0 {
            return None;
        }
        let n = self.count() as f64 - 1.0;
        let squares: f64 = products.iter().map(|h| h * h).sum();
        let square = n * n / ((n - 1.0) * (n + 2.0)) * (squares - trace * trace / n);
        // A frequency has a real and an imaginary part, so it counts as at most two numbers.
        let most = 2.0 * trace;
        Some((trace * trace / square.max(trace * trace / most)).clamp(1.0, most.max(1.0)))
    }
}
