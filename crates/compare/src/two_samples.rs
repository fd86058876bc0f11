//! Compares two measurements of one plane by the data that are stored in their results.

use crate::residuals::Residuals;
use crate::tail::{chi_squared_above, student_beyond};
use etendue_field::{Complex, SliceGrid, modulus};
use ndarray::{Array3, Zip};

/// One measurement of a plane: the mean over its batches, and its noise.
#[derive(Clone, Debug)]
pub struct Sample {
    /// The measured slices S, [azimuth, ρ ≥ 0, ν].
    pub mean: Array3<Complex>,
    /// The standard deviation of |S|, with the same axes.
    pub sigma: Array3<f64>,
    /// The effective number of independent real numbers in the noise ([`crate::noise_dof`]); `None`
    /// without noise.
    pub noise_dof: Option<f64>,
    /// Number of batches from which `sigma` was estimated.
    pub batches: usize,
}

/// The result of a test of two samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoSamples {
    /// Mean of |A − B|²/(σ_A² + σ_B²). It is corrected for the bias that arises because σ is an
    /// estimate. The expected value is 1 if A and B differ by noise only.
    pub chi2_per_dof: Option<f64>,
    /// Probability of differences at least as large if both samples have the same true slices.
    pub p_value: Option<f64>,
    /// Probability that the differences are at most as large as observed if the noise of both
    /// samples is independent. A value near 0 means that the samples share photons, or that σ is
    /// overstated.
    pub p_shared: Option<f64>,
    /// ‖A − B‖ divided by the larger of ‖A‖ and ‖B‖, over the independent frequencies; 0 if both
    /// are dark.
    pub difference: f64,
    /// √Σ(σ_A² + σ_B²) divided by the larger of ‖A‖ and ‖B‖: the difference that noise alone would
    /// cause.
    pub noise: f64,
}

/// The largest difference that rounding causes between sums of two programs, as a share of the
/// largest value.
const ROUNDING: f64 = 1e-12;

impl TwoSamples {
    /// Tests whether two samples have the same true slices.
    ///
    /// χ² over the independent frequencies is treated as χ² of ν independent numbers. Here ν^(−1/2)
    /// = w_A ν_A^(−1/2) + w_B ν_B^(−1/2), where w_A and w_B are the mean shares of the samples in
    /// the variance. The number ν is exact if the noise of both samples has the same correlations;
    /// otherwise it is conservative (Cauchy–Schwarz for tr C_A C_B). The estimate of σ has only n =
    /// 1/Σ w²/(R − 1) degrees of freedom. Therefore χ² is larger by the factor n/(n − 1), and its
    /// relative variance is larger by the factor n/(n − 2), as for an F distribution
    /// (docs/theory.md, section 6).
    ///
    /// # Panics
    /// Panics if the shapes of the arrays differ from the shape of the grid.
    #[must_use]
    pub fn new(grid: &SliceGrid, a: &Sample, b: &Sample) -> Self {
        let sums = FrequencySums::new(grid, a, b);
        let found = Self {
            chi2_per_dof: None,
            p_value: None,
            p_shared: None,
            difference: sums.relative(sums.difference),
            noise: sums.relative(sums.noise),
        };
        if sums.count == 0 {
            // If there is no noise, any difference is significant.
            let apart = sums.without_noise;
            let p_value = apart.then_some(0.0);
            return Self { p_value, ..found };
        }
        let count = sums.count as f64;
        let share = sums.share_of_a / count;
        let shares = [(share, a), (1.0 - share, b)];
        let root = |(w, sample): &(f64, &Sample)| w / sample.noise_dof.unwrap_or(1.0).sqrt();
        let known = |(w, sample): &(f64, &Sample)| w * w / (sample.batches as f64 - 1.0);
        let n = 1.0 / shares.iter().map(known).sum::<f64>();
        let dof = shares.iter().map(root).sum::<f64>().powi(-2) * (n - 2.0) / n;
        let chi2 = sums.chi2 / count * (n - 1.0) / n;
        let above = if sums.without_noise {
            0.0
        } else {
            chi_squared_above(dof * chi2, dof)
        };
        Self {
            chi2_per_dof: Some(chi2),
            p_value: Some(above),
            p_shared: Some(1.0 - above),
            ..found
        }
    }

    /// Tests whether two samples have the same true slices, from the differences B_b − A_b of their
    /// batches.
    ///
    /// Batches that use the same random numbers have nearly the same noise, which cancels in their
    /// difference. The differences are independent of each other, so their random signs give p, and
    /// their spread gives the noise of the mean. p is `None` if all differences are zero.
    ///
    /// # Panics
    /// Panics if the shapes of the arrays differ from the shape of the grid.
    #[must_use]
    pub fn paired(
        grid: &SliceGrid,
        [a, b]: [&Sample; 2],
        differences: &Residuals,
        seed: u64,
    ) -> Self {
        let sums = FrequencySums::new(grid, a, b);
        let variance = differences.variance();
        let noise = differences.sum(&variance, &variance, |v, _| *v);
        Self {
            chi2_per_dof: differences.chi2_per_dof(&variance),
            p_value: differences.within_error_of(&a.mean).p_value(seed),
            p_shared: None,
            difference: sums.relative(sums.difference),
            noise: sums.relative(noise),
        }
    }
}

/// Sums over the independent frequencies.
#[derive(Debug, Default)]
struct FrequencySums {
    /// Frequencies with noise.
    count: usize,
    /// Σ|A − B|²/(σ_A² + σ_B²).
    chi2: f64,
    /// Σσ_A²/(σ_A² + σ_B²).
    share_of_a: f64,
    /// Σ|A − B|².
    difference: f64,
    /// Σ(σ_A² + σ_B²).
    noise: f64,
    /// Σ|A|² and Σ|B|².
    norms: [f64; 2],
    /// Whether the samples differ at a frequency where neither sample has noise.
    without_noise: bool,
}

impl FrequencySums {
    fn new(grid: &SliceGrid, a: &Sample, b: &Sample) -> Self {
        let largest = |sample: &Sample| sample.mean.iter().map(|s| modulus(*s)).fold(0.0, f64::max);
        let rounding = ROUNDING * largest(a).max(largest(b));
        let mut sums = Self::default();
        let variances = Zip::from(&a.sigma)
            .and(&b.sigma)
            .map_collect(|a, b| [a * a, b * b]);
        Zip::indexed(&a.mean).and(&b.mean).and(&variances).for_each(
            |(_, m, n), a, b, variances| {
                if grid.is_independent(m, n) {
                    sums.add(*a, *b, *variances, rounding);
                }
            },
        );
        sums
    }

    /// The root of a sum of squares, divided by the larger of ‖A‖ and ‖B‖; 0 if both are dark.
    fn relative(&self, square: f64) -> f64 {
        let norm = self.norms[0].max(self.norms[1]).sqrt();
        if norm > 0.0 {
            square.sqrt() / norm
        } else {
            0.0
        }
    }

    fn add(&mut self, a: Complex, b: Complex, [of_a, of_b]: [f64; 2], rounding: f64) {
        let (square, variance) = ((a - b).norm_sqr(), of_a + of_b);
        self.difference += square;
        self.noise += variance;
        self.norms[0] += a.norm_sqr();
        self.norms[1] += b.norm_sqr();
        if variance > 0.0 {
            self.count += 1;
            self.chi2 += square / variance;
            self.share_of_a += of_a / variance;
        } else {
            self.without_noise |= square.sqrt() > rounding;
        }
    }
}

/// A number with its standard error, estimated from some number of batches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// The standard error of the number.
    pub error: f64,
    /// Number of batches from which the error was estimated.
    pub batches: usize,
}

/// The pull of two estimates of one number, (a − b)/√(e_a² + e_b²). Also returns the
/// probability that the absolute value of the pull is at least this large if both estimates have
/// the same true value.
///
/// The test follows Welch (1947): Student's t with n = (e_a² + e_b²)²/Σ e⁴/(R − 1) degrees of
/// freedom. Returns `None` where neither estimate has an error.
#[must_use]
pub fn pull(a: Estimate, b: Estimate) -> Option<(f64, f64)> {
    let squares = [a, b].map(|e| (e.error * e.error, e.batches as f64 - 1.0));
    let variance: f64 = squares.iter().map(|(square, _)| square).sum();
    if variance.is_nan() || variance <= 0.0 {
        return None;
    }
    let known: f64 = squares.iter().map(|(square, n)| square * square / n).sum();
    let pull = (a.value - b.value) / variance.sqrt();
    Some((pull, student_beyond(pull, variance * variance / known)))
}
