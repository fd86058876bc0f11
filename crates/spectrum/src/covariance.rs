//! Estimates the covariance of the coordinates of a light field's rays, with standard errors.

use crate::estimate::TooFewBatches;
use crate::jackknife::Jackknife;
use crate::measurement::Measurement;
use crate::ray_moments::RayMoments;
use ndarray::Array2;

/// The covariance of a windowed light field.
#[derive(Clone, Debug, PartialEq)]
pub struct CovarianceEstimate {
    /// Central second moments over (x, y, u, v), [4, 4].
    pub value: Array2<f64>,
    /// The standard errors of the moments, by the delete-one jackknife.
    pub error: Array2<f64>,
}

/// The covariance of the windowed light field at plane `plane`; `None` if no light arrived.
///
/// # Errors
///
/// Fails with fewer than two batches.
pub fn covariance(
    measurement: &Measurement,
    plane: usize,
) -> Result<Option<CovarianceEstimate>, TooFewBatches> {
    TooFewBatches::check(measurement, 2)?;
    let batches = || measurement.at_plane(plane).map(|batch| batch.moments.0);
    let mut total = [0.0; RayMoments::COUNT];
    for batch in batches() {
        total.iter_mut().zip(batch).for_each(|(sum, s)| *sum += s);
    }
    let Some(value) = RayMoments(total).covariance() else {
        return Ok(None);
    };
    let mut jackknife = Jackknife::new(value.raw_dim());
    for batch in batches() {
        let mut without = total;
        without.iter_mut().zip(batch).for_each(|(sum, s)| *sum -= s);
        if let Some(covariance) = RayMoments(without).covariance() {
            jackknife.add(&covariance);
        }
    }
    let error = jackknife.variance().mapv(f64::sqrt);
    Ok(Some(CovarianceEstimate { value, error }))
}
