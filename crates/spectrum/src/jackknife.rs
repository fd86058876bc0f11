//! Computes standard errors by the delete-one jackknife over batches.

use ndarray::{Array, Dimension};
use serde::Serialize;

/// A number and its standard error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Uncertain {
    /// The number.
    pub value: f64,
    /// The standard error of the number.
    pub error: f64,
}

/// The delete-one jackknife. Let θ_r be the estimate without batch r. The variance of the estimate
/// from all R batches is (R−1)/R Σ (θ_r − θ̄)² (Efron and Stein 1981).
///
/// The jackknife receives the values one after another and keeps running sums (Welford 1962).
pub(crate) struct Jackknife<D: Dimension> {
    count: usize,
    mean: Array<f64, D>,
    squares: Array<f64, D>,
}

impl<D: Dimension> Jackknife<D> {
    /// Builds a jackknife for values of the given shape.
    pub(crate) fn new(shape: D) -> Self {
        Self {
            count: 0,
            mean: Array::zeros(shape.clone()),
            squares: Array::zeros(shape),
        }
    }

    /// Adds the next value, which is the estimate with one batch left out.
    pub(crate) fn add(&mut self, value: &Array<f64, D>) {
        self.count += 1;
        let count = self.count as f64;
        ndarray::Zip::from(&mut self.mean)
            .and(&mut self.squares)
            .and(value)
            .for_each(|mean, squares, value| {
                let from_old = value - *mean;
                *mean += from_old / count;
                *squares += from_old * (value - *mean);
            });
    }

    /// The variance of the estimate.
    pub(crate) fn variance(self) -> Array<f64, D> {
        let count = self.count as f64;
        self.squares * ((count - 1.0) / count)
    }

    /// The variance of the values themselves, with the divisor R − 1; zero for one value.
    pub(crate) fn sample_variance(self) -> Array<f64, D> {
        self.squares / (self.count as f64 - 1.0).max(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::arr0;

    #[test]
    fn the_variance_of_a_mean_is_the_usual_one() {
        let values = [1.0, 4.0, -2.0, 0.5, 7.0];
        let n = values.len() as f64;
        let sum: f64 = values.iter().sum();
        let mut jackknife = Jackknife::new(ndarray::Ix0());
        for value in values {
            jackknife.add(&arr0((sum - value) / (n - 1.0)));
        }
        let squares: f64 = values.iter().map(|v| (v - sum / n).powi(2)).sum();
        let usual = squares / (n * (n - 1.0));
        assert!((jackknife.variance().into_scalar() - usual).abs() < 1e-14); // rounding
    }
}
