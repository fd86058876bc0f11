//! Compares the full radial spectrum of a plane with its prediction.

use crate::field::PredictedField;
use crate::power::{BinDifference, PowerReport, PowerSums, crossed};
use etendue_spectrum::field::{
    FieldGroup, FieldMeasurement, FieldSpectrum, FullRadial, RadialBins,
};
use ndarray::Array2;
use serde::Serialize;

/// The full radial spectrum in `summary.json`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FullRadialReport {
    /// The comparison of the power.
    #[serde(flatten)]
    pub power: PowerReport,
    /// The largest |aliasing|/σ of a bin. The prediction contains the same aliasing. The value is
    /// `None` where aliasing is not known separately.
    pub aliasing: Option<f64>,
}

/// A comparison of a full radial spectrum: the report, and the arrays from which the report is
/// computed, [|Ωxy|, |Ωuv|].
#[derive(Clone, Debug)]
pub struct FullRadialComparison {
    /// Every number.
    pub report: FullRadialReport,
    /// The measured full radial spectrum, with its bins.
    pub measured: FullRadial,
    /// The predicted power, aliasing included, without the noise of its rays.
    pub predicted: Array2<f64>,
    /// Standard deviation of measured minus predicted, if the prediction is true.
    pub sigma: Array2<f64>,
}

impl FullRadialComparison {
    /// Compares a measurement, which must have its groups, with a prediction on the same grid.
    /// `seed` is the seed of the random signs of the p-value.
    ///
    /// # Panics
    /// Panics if the prediction comes in groups that differ from the groups of the measurement.
    #[must_use]
    pub fn new(measured: &FieldMeasurement, predicted: &PredictedField, seed: u64) -> Self {
        let bins = RadialBins::new(&measured.grid);
        let (report, predicted, sigma) = compared(&bins, &measured.groups, predicted, seed);
        Self {
            report,
            measured: measured.full_radial.clone(),
            predicted,
            sigma,
        }
    }
}

impl FullRadialReport {
    /// Compares the groups of a measurement with a prediction on the same grid.
    ///
    /// # Panics
    /// Panics as [`FullRadialComparison::new`] does.
    #[must_use]
    pub fn new(
        bins: &RadialBins,
        groups: &[FieldGroup],
        predicted: &PredictedField,
        seed: u64,
    ) -> Self {
        compared(bins, groups, predicted, seed).0
    }
}

/// The report, the predicted power and σ of the difference, for the groups of a
/// measurement.
fn compared(
    bins: &RadialBins,
    groups: &[FieldGroup],
    predicted: &PredictedField,
    seed: u64,
) -> (FullRadialReport, Array2<f64>, Array2<f64>) {
    let shares: Vec<f64> = groups.iter().map(|group| group.share).collect();
    let spectra = groups.iter().map(|group| &group.spectrum);
    let spectra: Vec<&FieldSpectrum> = spectra.chain(predicted.spectra()).collect();
    let n = shares.len();
    assert!(
        [n + 1, 2 * n].contains(&spectra.len()),
        "the prediction and the measurement have different groups"
    );
    let products = bins.products(&spectra);
    let mut sums = PowerSums::new(n);
    let [mut power, mut sigma] = [0; 2].map(|_| Array2::zeros(bins.counts.raw_dim()));
    let each = products.outer_iter().zip(power.iter_mut().zip(&mut sigma));
    for (products, (power, sigma)) in each {
        let difference = BinDifference::new(products, &shares);
        *power = match predicted {
            PredictedField::Exact { .. } => products[[n, n]],
            PredictedField::Sampled(_) => crossed(products, n),
        };
        let variance = difference.variance();
        *sigma = variance.sqrt();
        sums.add(&difference, variance, *power);
    }
    let alias_free = match predicted {
        PredictedField::Exact { alias_free, .. } => alias_free.as_ref(),
        PredictedField::Sampled(_) => None,
    };
    let aliasing = alias_free.map(|free| {
        let each = power.iter().zip(free).zip(&sigma);
        let each = each.filter(|(_, sigma)| **sigma > 0.0);
        each.map(|((with, free), sigma)| (with - free).abs() / sigma)
            .fold(0.0, f64::max)
    });
    let report = FullRadialReport {
        power: sums.report(seed),
        aliasing,
    };
    (report, power, sigma)
}
