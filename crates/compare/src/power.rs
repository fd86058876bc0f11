//! Tests measured power against predicted power, in bins of frequencies.

use crate::signs::p_of_signs;
use ndarray::{Array2, ArrayView2};
use serde::Serialize;

/// The comparison of the power in all bins of a radial spectrum, in `summary.json`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PowerReport {
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
pub(crate) struct BinDifference {
    /// The linear terms 2 Σ_(s≠r) D_r·S_s/(1 − Σa²), for each group r.
    linear: Vec<f64>,
    /// The terms 2 (2α − 1) D_r·D_s/(1 − Σa²) of pairs of groups, row by row for s < r.
    pairs: Vec<f64>,
}

impl BinDifference {
    /// Computes the difference from the products of the spectra in a bin. The spectra belong to the
    /// prediction and to the groups, whose shares are `a`.
    pub(crate) fn new(products: ArrayView2<'_, f64>, a: &[f64]) -> Self {
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

    /// The terms of U: first those of each group, then those of pairs of groups.
    fn terms(&self) -> impl Iterator<Item = f64> {
        self.linear.iter().chain(&self.pairs).copied()
    }

    /// The variance of U over all choices of signs.
    pub(crate) fn variance(&self) -> f64 {
        self.terms().map(|term| term * term).sum()
    }

    /// The variance over all choices of signs of the terms of pairs.
    pub(crate) fn variance_of_pairs(&self) -> f64 {
        self.pairs.iter().map(|term| term * term).sum()
    }
}

/// Σ_r |G_r − a_r G|², from the products of the groups.
fn spread(product: &dyn Fn(usize, usize) -> f64, a: &[f64]) -> f64 {
    let n = a.len();
    let row = |r: usize| (0..n).map(|s| product(r, s)).sum::<f64>();
    let all: f64 = (0..n).map(row).sum();
    let each = (0..n).map(|r| product(r, r) - 2.0 * a[r] * row(r) + a[r] * a[r] * all);
    each.sum::<f64>().max(0.0)
}

/// The mean product of two different groups, which is the power without noise. The groups
/// are counted from number `first` on.
pub(crate) fn crossed(products: ArrayView2<'_, f64>, first: usize) -> f64 {
    let all = products.indexed_iter();
    let pairs = all.filter(|((r, s), _)| first <= *r.min(s) && r != s);
    let n = (products.nrows() - first) as f64;
    pairs.map(|(_, product)| product).sum::<f64>() / (n * (n - 1.0))
}

/// The sums over all bins from which the test of a radial spectrum follows.
///
/// The statistic is Σ U²/var U over the bins, where var U is any estimate that does not depend on
/// the signs of the D_r. With the signs ε_r of the D_r, U is a sum of terms t_i times factors φ_i,
/// which are the signs ε_r and the products ε_r ε_s. Therefore the statistic is a quadratic form of
/// the φ, and its matrix Σ t tᵀ/var U is computed once for all signs.
#[derive(Clone)]
pub(crate) struct PowerSums {
    groups: usize,
    bins: usize,
    /// The matrix of the quadratic form; only entries on and below the diagonal are set.
    form: Array2<f64>,
    /// The statistic as measured.
    observed: f64,
    /// Sums over bins of U², of var U and of the squared predicted power.
    squares: [f64; 3],
}

impl PowerSums {
    pub(crate) fn new(groups: usize) -> Self {
        let terms = groups * (groups + 1) / 2;
        Self {
            groups,
            bins: 0,
            form: Array2::zeros((terms, terms)),
            observed: 0.0,
            squares: [0.0; 3],
        }
    }

    /// Adds a bin with an estimate of the variance of U, and with its predicted power.
    pub(crate) fn add(&mut self, bin: &BinDifference, variance: f64, predicted: f64) {
        let difference: f64 = bin.terms().sum();
        let squares = [difference * difference, variance, predicted * predicted];
        for (sum, square) in self.squares.iter_mut().zip(squares) {
            *sum += square;
        }
        // Bins without noise, such as all bins of a dark field, have nothing to test.
        if variance <= 0.0 {
            return;
        }
        self.bins += 1;
        self.observed += difference * difference / variance;
        let terms: Vec<f64> = bin.terms().collect();
        for (i, mut row) in self.form.outer_iter_mut().enumerate() {
            let factor = terms[i] / variance;
            let row = row.iter_mut().zip(&terms[..=i]);
            row.for_each(|(sum, term)| *sum += factor * term);
        }
    }

    /// Adds the sums over other bins.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.bins += other.bins;
        self.form += &other.form;
        self.observed += other.observed;
        for (sum, more) in self.squares.iter_mut().zip(other.squares) {
            *sum += more;
        }
    }

    /// Every number. `seed` is the seed of the random signs of the p-value.
    pub(crate) fn report(&self, seed: u64) -> PowerReport {
        let [difference, variance, predicted] = self.squares;
        let relative = |square: f64| (predicted > 0.0).then(|| (square / predicted).sqrt());
        let is_noisy = self.bins > 0;
        PowerReport {
            bins: self.bins,
            chi2_per_bin: is_noisy.then(|| self.observed / self.bins as f64),
            p_value: is_noisy.then(|| p_of_signs(&self.form, self.groups, seed, with_products)),
            relative_error: relative(difference),
            noise_limit: relative(variance),
        }
    }
}

/// The factors φ of the terms of U: the signs, and the products of two signs.
fn with_products<const N: usize>(mut signs: Vec<[f64; N]>) -> Vec<[f64; N]> {
    let pairs = (0..signs.len()).flat_map(|r| (0..r).map(move |s| [r, s]));
    let product = |[r, s]: [usize; 2]| std::array::from_fn(|lane| signs[r][lane] * signs[s][lane]);
    let products: Vec<[f64; N]> = pairs.map(product).collect();
    signs.extend(products);
    signs
}

#[cfg(test)]
mod tests {
    use super::*;
    /// Returns pseudo-random numbers about zero.
    fn noise(count: usize, seed: f64) -> Vec<f64> {
        let each = (0..count).map(|i| libm::sin(1e4 * (seed + 1.7 * i as f64)));
        each.collect()
    }

    /// The products of the spectra in one bin of two frequencies. The spectra belong to the
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
            let found: f64 = difference.terms().sum();
            assert!((found - expected).abs() < 1e-14, "{found} {expected}"); // rounding
        }
    }

    /// U with the given signs of the D_r.
    fn with_signs(difference: &BinDifference, signs: [f64; 4]) -> f64 {
        let factors = with_products(signs.map(|sign| [sign]).to_vec());
        difference.terms().zip(factors).map(|(t, [f])| t * f).sum()
    }

    fn all_signs() -> impl Iterator<Item = [f64; 4]> {
        (0..16).map(|bits: u32| [0, 1, 2, 3].map(|r| if bits >> r & 1 == 0 { 1.0 } else { -1.0 }))
    }

    #[test]
    fn the_variance_is_that_over_all_signs() {
        let (products, shares, _) = products(false);
        let difference = BinDifference::new(products.view(), &shares);
        let all = all_signs().map(|signs| with_signs(&difference, signs).powi(2));
        let mean = all.sum::<f64>() / 16.0;
        assert!((difference.variance() / mean - 1.0).abs() < 1e-13); // rounding
    }

    /// Tests the p-value of two bins against the share of all sixteen choices of signs.
    #[test]
    fn p_is_the_share_of_signs_with_a_larger_statistic() {
        let bins = [true, false].map(|exact| {
            let (products, shares, _) = products(exact);
            BinDifference::new(products.view(), &shares)
        });
        let mut sums = PowerSums::new(4);
        bins.iter()
            .for_each(|bin| sums.add(bin, bin.variance(), 1.0));
        let statistic = |signs: [f64; 4]| -> f64 {
            let each = bins.iter();
            each.map(|bin| with_signs(bin, signs).powi(2) / bin.variance())
                .sum()
        };
        let observed = statistic([1.0; 4]);
        let reached = all_signs().filter(|signs| statistic(*signs) >= observed * (1.0 - 1e-12));
        let share = reached.count() as f64 / 16.0;
        let report = sums.report(1);
        assert!((report.chi2_per_bin.unwrap() - observed / 2.0).abs() < 1e-12); // rounding
        // 20,000 rounds tell a share to 0.0035.
        assert!((report.p_value.unwrap() - share).abs() < 0.014, "{share}");
    }
}
