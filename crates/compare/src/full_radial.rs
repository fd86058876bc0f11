//! Compares the full radial spectrum of a plane with its prediction.

use crate::field::PredictedField;
use crate::residuals::{ROUNDS, signs};
use etendue_spectrum::field::{
    FieldGroup, FieldMeasurement, FieldSpectrum, FullRadial, RadialBins,
};
use ndarray::{Array2, ArrayView2};
use rayon::prelude::*;
use serde::Serialize;

/// The full radial spectrum in `summary.json`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FullRadialReport {
    /// Number of bins with noise. The other numbers are computed from these bins.
    pub bins: usize,
    /// The mean of (measured − predicted)²/σ², which is about 1 if the prediction is true.
    pub chi2_per_bin: Option<f64>,
    /// Probability of a disagreement at least this large if the prediction is true.
    pub p_value: Option<f64>,
    /// ‖measured − predicted‖/‖predicted‖ of the power.
    pub relative_error: Option<f64>,
    /// The relative error that noise alone would cause.
    pub noise_limit: Option<f64>,
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

/// The difference of measured and predicted power in a bin, as a sum over the groups of photons.
///
/// Group r holds the share a_r of the measurement, G_r, and the same share of the prediction, P_r;
/// both have the expectation a_r F. Both powers are computed from pairs of groups, so their
/// difference is U = Σ_(r≠s) (G_r·G_s − P_r·P_s)/(1 − Σa²). Let D_r = G_r − P_r, and let S_r = G_r
/// − α D_r be the weighted mean of G_r and P_r that is not correlated with D_r. Then the difference
/// is
///
/// U (1 − Σa²) = Σ_r D_r·(2 Σ_(s≠r) S_s) + (2α − 1) Σ_(r≠s) D_r·D_s.
///
/// If the prediction is true, D_r and −D_r are equally likely, whatever the values of the other D
/// and of the S are (docs/theory.md (45)).
struct BinDifference {
    /// The linear terms 2 Σ_(s≠r) D_r·S_s/(1 − Σa²), for each group r.
    linear: Vec<f64>,
    /// The terms 2 (2α − 1) D_r·D_s/(1 − Σa²) of pairs of groups, row by row for s < r.
    pairs: Vec<f64>,
}

impl BinDifference {
    /// Computes the difference from the products of the spectra in a bin. The spectra belong to the
    /// prediction and to the groups, whose shares are `a`.
    fn new(products: ArrayView2<'_, f64>, a: &[f64]) -> Self {
        let n = a.len();
        let is_exact = products.nrows() == n + 1;
        let at = |r: usize| if is_exact { n } else { n + r };
        let gg = |r: usize, s: usize| products[[r, s]];
        let gp = |r: usize, s: usize| a[s] * products[[r, at(s)]];
        let pp = |r: usize, s: usize| a[r] * a[s] * products[[at(r), at(s)]];
        let noise = [spread(&gg, a), if is_exact { 0.0 } else { spread(&pp, a) }];
        let all = noise[0] + noise[1];
        let alpha = if all > 0.0 { noise[0] / all } else { 1.0 };
        let norm = 1.0 - a.iter().map(|a| a * a).sum::<f64>();
        let d_s = |r: usize, s: usize| {
            (1.0 - alpha) * (gg(r, s) - gp(s, r)) + alpha * (gp(r, s) - pp(r, s))
        };
        let d_d = |r: usize, s: usize| gg(r, s) - gp(r, s) - gp(s, r) + pp(r, s);
        let linear = (0..n).map(|r| {
            let others = (0..n).filter(|s| *s != r);
            2.0 * others.map(|s| d_s(r, s)).sum::<f64>() / norm
        });
        let pairs = (0..n).flat_map(|r| (0..r).map(move |s| (r, s)));
        Self {
            linear: linear.collect(),
            pairs: pairs
                .map(|(r, s)| 2.0 * (2.0 * alpha - 1.0) * d_d(r, s) / norm)
                .collect(),
        }
    }

    /// Returns U with the given signs of the D_r.
    fn with_signs(&self, signs: &[f64]) -> f64 {
        let mut pairs = self.pairs.as_slice();
        let mut sum = 0.0;
        for (r, (linear, sign)) in self.linear.iter().zip(signs).enumerate() {
            let (row, rest) = pairs.split_at(r);
            pairs = rest;
            let of_pairs: f64 = row.iter().zip(signs).map(|(pair, s)| pair * s).sum();
            sum += sign * (linear + of_pairs);
        }
        sum
    }

    /// Returns the variance of U over all choices of signs.
    fn variance(&self) -> f64 {
        let terms = self.linear.iter().chain(&self.pairs);
        terms.map(|term| term * term).sum()
    }
}

/// Returns Σ_r |G_r − a_r G|², from the products of the groups.
fn spread(product: &dyn Fn(usize, usize) -> f64, a: &[f64]) -> f64 {
    let n = a.len();
    let row = |r: usize| (0..n).map(|s| product(r, s)).sum::<f64>();
    let all: f64 = (0..n).map(row).sum();
    let each = (0..n).map(|r| product(r, r) - 2.0 * a[r] * row(r) + a[r] * a[r] * all);
    each.sum::<f64>().max(0.0)
}

/// Returns the mean product of two different groups, which is the power without noise. The groups
/// are counted from number `first` on.
fn crossed(products: ArrayView2<'_, f64>, first: usize) -> f64 {
    let all = products.indexed_iter();
    let pairs = all.filter(|((r, s), _)| first <= *r.min(s) && r != s);
    let n = (products.nrows() - first) as f64;
    pairs.map(|(_, product)| product).sum::<f64>() / (n * (n - 1.0))
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

/// Returns the report, the predicted power and σ of the difference, for the groups of a
/// measurement.
pub(crate) fn compared(
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
    let each = || products.outer_iter();
    let differences: Vec<BinDifference> =
        each().map(|of| BinDifference::new(of, &shares)).collect();
    let power = each().map(|of| match predicted {
        PredictedField::Exact { .. } => of[[n, n]],
        PredictedField::Sampled(_) => crossed(of, n),
    });
    let shape = bins.counts.raw_dim();
    let of_bins = |values: Vec<f64>| Array2::from_shape_vec(shape, values).expect("of each bin");
    let power = of_bins(power.collect());
    let sigma = differences.iter().map(|bin| bin.variance().sqrt());
    let sigma = of_bins(sigma.collect());
    let aliasing = match predicted {
        PredictedField::Exact { alias_free, .. } => alias_free.as_ref(),
        PredictedField::Sampled(_) => None,
    };
    let report = report(&differences, (&power, &sigma), aliasing, seed);
    (report, power, sigma)
}

/// Computes every number from the differences of all bins.
fn report(
    differences: &[BinDifference],
    (power, sigma): (&Array2<f64>, &Array2<f64>),
    alias_free: Option<&Array2<f64>>,
    seed: u64,
) -> FullRadialReport {
    // Bins without noise, such as all bins of a dark field, have nothing to test.
    let noisy: Vec<(&BinDifference, f64)> = differences
        .iter()
        .map(|bin| (bin, bin.variance()))
        .filter(|(_, variance)| *variance > 0.0)
        .collect();
    let statistic = |signs: &[f64]| -> f64 {
        let each = noisy.iter();
        each.map(|(bin, variance)| bin.with_signs(signs).powi(2) / variance)
            .sum()
    };
    let groups = differences.first().map_or(0, |bin| bin.linear.len());
    let unsigned = vec![1.0; groups];
    let observed = statistic(&unsigned);
    let reached = || {
        let rounds = (0..ROUNDS).into_par_iter();
        rounds
            .filter(|round| {
                statistic(&signs(seed, *round).take(groups).collect::<Vec<_>>()) >= observed
            })
            .count()
    };
    let size: f64 = power.iter().map(|p| p * p).sum();
    let relative = |square: f64| (size > 0.0).then(|| (square / size).sqrt());
    let squares = differences.iter();
    let squares = squares.map(|bin| bin.with_signs(&unsigned).powi(2));
    let aliases = alias_free.map(|free| {
        let each = power.iter().zip(free).zip(sigma);
        let each = each.filter(|(_, sigma)| **sigma > 0.0);
        each.map(|((with, free), sigma)| (with - free).abs() / sigma)
            .fold(0.0, f64::max)
    });
    let is_noisy = !noisy.is_empty();
    FullRadialReport {
        bins: noisy.len(),
        chi2_per_bin: is_noisy.then(|| observed / noisy.len() as f64),
        p_value: is_noisy.then(|| (reached() + 1) as f64 / (ROUNDS + 1) as f64),
        relative_error: relative(squares.sum()),
        noise_limit: relative(sigma.iter().map(|sigma| sigma * sigma).sum()),
        aliasing: aliases,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;

    /// Returns pseudo-random numbers about zero.
    fn noise(count: usize, seed: f64) -> Vec<f64> {
        let each = (0..count).map(|i| libm::sin(1e4 * (seed + 1.7 * i as f64)));
        each.collect()
    }

    /// Returns the products of the spectra in one bin of two frequencies. The spectra belong to the
    /// groups of a measurement and to a prediction.
    fn products(exact: bool) -> (Array2<f64>, Vec<f64>, f64) {
        let shares = vec![0.25, 0.25, 0.3, 0.2];
        let truth = [1.5, -0.4];
        let spectrum = |share: f64, seed: f64, size: f64| {
            let noise = noise(2, seed);
            [0, 1].map(|i| share * truth[i] + size * noise[i])
        };
        let measured: Vec<[f64; 2]> = (0..4).map(|r| spectrum(shares[r], r as f64, 0.1)).collect();
        let predicted: Vec<[f64; 2]> = if exact {
            vec![truth]
        } else {
            (0..4).map(|r| spectrum(1.0, 9.0 + r as f64, 0.3)).collect()
        };
        let norm = 1.0 - shares.iter().map(|a| a * a).sum::<f64>();
        let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
        let mut expected = 0.0;
        for (r, s) in (0..4).flat_map(|r| (0..4).map(move |s| (r, s))) {
            if r != s {
                let p = if exact {
                    dot(truth, truth)
                } else {
                    dot(predicted[r], predicted[s])
                };
                expected += dot(measured[r], measured[s]) - shares[r] * shares[s] * p;
            }
        }
        let all: Vec<[f64; 2]> = measured.into_iter().chain(predicted).collect();
        let n = all.len();
        let products = Array2::from_shape_fn((n, n), |(i, j)| dot(all[i], all[j]));
        (products, shares, expected / norm)
    }

    #[test]
    fn terms_add_up_to_the_difference_of_both_powers() {
        for exact in [true, false] {
            let (products, shares, expected) = products(exact);
            let difference = BinDifference::new(products.view(), &shares);
            let found = difference.with_signs(&[1.0; 4]);
            assert!((found - expected).abs() < 1e-14, "{found} {expected}"); // rounding
        }
    }

    #[test]
    fn the_variance_is_that_over_all_signs() {
        let (products, shares, _) = products(false);
        let difference = BinDifference::new(products.view(), &shares);
        let all = (0..16).map(|bits: u32| {
            let signs = [0, 1, 2, 3].map(|r| if bits >> r & 1 == 0 { 1.0 } else { -1.0 });
            difference.with_signs(&signs).powi(2)
        });
        let mean = all.sum::<f64>() / 16.0;
        assert!((difference.variance() / mean - 1.0).abs() < 1e-13); // rounding
    }
}
