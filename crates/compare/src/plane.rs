//! A plane of a measurement held against its prediction.

use crate::first_order::FirstOrderReport;
use crate::prediction::Prediction;
use crate::report::{Bandwidth, Covariance, HighFrequencyShare, Pair, PlaneReport};
use crate::residuals::Residuals;
use crate::score::score;
use crate::verdict::Verdict;
use etendue_field::{Complex, PlaneTally, SliceGrid, Slices, tidy};
use etendue_spectrum::estimate::{self, ProjectionEstimate, TooFewBatches};
use etendue_spectrum::moments::{
    BANDWIDTH_FRACTION, bandwidth_nu, bandwidth_rho, high_frequency_share, second_moment,
    shear_slope,
};
use etendue_spectrum::{CrossPower, Measurement, RadialPower};
use ndarray::{Array2, Array3, ArrayView2, Axis};

/// A plane compared: the report, and the arrays behind it.
#[derive(Clone, Debug)]
pub struct PlaneComparison {
    /// Every number, and the verdict.
    pub report: PlaneReport,
    /// The measured slices: the mean over batches.
    pub measured: Slices,
    /// The predicted slices, without what rounding leaves of a dark field.
    pub predicted: Slices,
    /// Standard deviation of |S − F|, [azimuth, ρ ≥ 0, ν].
    pub sigma: Array3<f64>,
    /// The measured radial spectrum.
    pub radial: RadialPower,
    /// The predicted radial spectrum, [ρ, ν].
    pub predicted_radial: Array2<f64>,
    /// Standard deviation of measured minus predicted radial power if the prediction is true, [ρ, ν].
    pub radial_sigma: Array2<f64>,
    /// The measured light field in (x, u).
    pub projection: ProjectionEstimate,
}

/// A field of which less than this share of the light without blockers is left is predicted to be dark:
/// a prediction is a difference of transforms of that size, good to 10⁻¹⁵ of it.
const DARK: f64 = 1e-12;

/// Compares plane `index` of a measurement with its prediction; it passes when p ≥ `level`.
///
/// `seed` keys the random signs of the p-value.
///
/// # Errors
/// When the measurement has too few batches for errors.
pub fn compare(
    measurement: &Measurement,
    index: usize,
    prediction: &Prediction,
    level: f64,
    seed: u64,
) -> Result<PlaneComparison, TooFewBatches> {
    let plane = &measurement.planes()[index];
    let tally = measurement.tally(index);
    let predicted = without_rounding(prediction);
    let estimate = estimate::slices(measurement, index)?;
    let is_reference = !prediction.replicates.is_empty();
    let residuals = if is_reference {
        Residuals::between(measurement, index, &prediction.replicates)
    } else {
        Residuals::new(measurement, index, &predicted)
    };
    // Theory is without noise, a reference adds its own.
    let variance = if is_reference {
        residuals.variance()
    } else {
        estimate.variance
    };
    let power = CrossPower::new(measurement, index)?;
    // That of a mean holds the noise of its batches; crossed with each other they have none in common.
    let predicted_radial = if is_reference {
        crossed_power(&prediction.replicates)
    } else {
        predicted.radial_power()
    };
    let agreement = Agreement::new(&residuals, &variance, &predicted);
    let p_value = residuals.p_value(seed);
    let first_order = prediction.first_order.as_ref();
    let first_order =
        first_order.map(|f| f.report(measurement, index, (&predicted, &residuals), seed));
    let agrees = agrees(&predicted, &tally, p_value, level);
    let is_blurred = agreement.is_blurred(prediction.quadrature_error, agrees);
    let verdict = if is_blurred {
        Verdict::Undecided
    } else {
        agreement.verdict(agrees)
    };
    // The worse of the two: what rays do, and what the first-order chain makes of it.
    let verdict = first_order
        .as_ref()
        .map_or(verdict, |f| verdict.and(f.verdict));
    let grid = &plane.grid;
    let quadrature = prediction.quadrature_error.zip(agreement.noise_limit());
    let pair =
        |of: &dyn Fn(ArrayView2<'_, f64>) -> Option<f64>| pair(&power, &predicted_radial, of);

    let report = PlaneReport {
        name: plane.name.clone(),
        class: prediction.class,
        chain: prediction.steps.clone(),
        // That of a dark field is a ratio of roundings.
        quadrature_error: quadrature.map(|(error, _)| error),
        frame: plane.frame,
        distance: plane.distance,
        crossed: tally.crossed,
        in_window: tally.inside,
        outside_window: tally.outside,
        relative_error: agreement.relative_error(),
        noise_limit: agreement.noise_limit(),
        excess: agreement.excess(),
        excess_squared_error: agreement.excess_squared_error,
        noise_floor_db: agreement.noise_floor_db,
        chi2_per_dof: residuals.chi2_per_dof(&variance),
        p_value,
        parameters: prediction
            .parameters
            .iter()
            .filter_map(|p| score(&residuals, &variance, p))
            .collect(),
        slope: pair(&|p| shear_slope(p, grid)),
        spectral_moments: [[2, 0], [1, 1], [0, 2]]
            .map(|powers| pair(&|p| second_moment(p, grid, powers))),
        bandwidth_95: Bandwidth {
            rho: pair(&|p| bandwidth_rho(p, grid, BANDWIDTH_FRACTION)),
            nu: pair(&|p| bandwidth_nu(p, grid, BANDWIDTH_FRACTION)),
        },
        covariance: covariance(measurement, index, prediction)?,
        high_frequency_share: prediction
            .cuts
            .iter()
            .map(|&cut| HighFrequencyShare {
                cut,
                share: pair(&|p| high_frequency_share(p, grid, cut)),
            })
            .collect(),
        photons_needed: (verdict == Verdict::Undecided && !is_blurred).then(|| {
            let noise = agreement.noise_limit().unwrap_or_default();
            let enough = first_order.as_ref().map_or(1.0, FirstOrderReport::more);
            photons_needed(measurement.emitted(), noise).max(measurement.emitted() as f64 * enough)
        }),
        verdict,
        first_order,
        warnings: warnings(&predicted_radial, grid, quadrature),
    };
    Ok(PlaneComparison {
        report,
        measured: estimate.mean,
        radial: power.radial(),
        radial_sigma: residuals.radial_sigma(&predicted, &variance),
        sigma: variance.mapv(f64::sqrt),
        predicted_radial,
        predicted,
        projection: estimate::projection(measurement, index)?,
    })
}

/// The second moments of the photons, and those predicted.
fn covariance(
    measurement: &Measurement,
    index: usize,
    prediction: &Prediction,
) -> Result<Option<Covariance>, TooFewBatches> {
    let matrix =
        |array: &Array2<f64>| std::array::from_fn(|i| std::array::from_fn(|j| array[[i, j]]));
    let chain = prediction.first_order.as_ref().map(|f| f.chain.covariance);
    let [predicted, propagated] = chain.unwrap_or_default();
    let measured = etendue_spectrum::covariance(measurement, index)?;
    Ok(measured.map(|measured| Covariance {
        measured: matrix(&measured.value),
        error: matrix(&measured.error),
        predicted,
        propagated,
    }))
}

/// The radial power of a reference from its batches, without their noise (docs/theory.md, Eq. 13), [ρ, ν].
fn crossed_power(replicates: &[Slices]) -> Array2<f64> {
    let grid = replicates[0].grid;
    let mut sum = Array3::<Complex>::zeros(grid.half_shape());
    let mut own = Array3::<f64>::zeros(grid.half_shape());
    for batch in replicates {
        sum += &batch.half;
        own.zip_mut_with(&batch.half, |own, s| *own += s.norm_sqr());
    }
    let r = replicates.len() as f64;
    let crossed = sum.mapv(|s| s.norm_sqr()) - own;
    let radial = crossed.sum_axis(Axis(0)) / (r * (r - 1.0) * grid.azimuths as f64);
    grid.unfold_radial(radial.view())
}

/// A number read off both powers by the same estimator.
fn pair(
    power: &CrossPower<'_>,
    predicted: &Array2<f64>,
    of: &dyn Fn(ArrayView2<'_, f64>) -> Option<f64>,
) -> Pair {
    let measured = power.statistic(of);
    Pair {
        measured: measured.map(|m| m.value),
        predicted: of(predicted.view()),
        error: measured.map(|m| m.error),
    }
}

/// The predicted slices; those of a dark field, which are differences that rounding has left, are zero.
fn without_rounding(prediction: &Prediction) -> Slices {
    let least = prediction.unblocked * DARK;
    let dark = prediction.slices.half.iter().all(|f| f.norm() <= least);
    if dark {
        Slices::zeros(prediction.slices.grid)
    } else {
        prediction.slices.clone()
    }
}

/// The largest noise, as a share of the spectrum, with which agreement means something.
const RESOLVED: f64 = 0.5;

/// The largest error of a quadrature, as a share of the noise, with which agreement means something: it is an upper estimate, and adds a
/// quarter to χ² at the most.
const BLURRED: f64 = 0.5;

/// Whether p reaches the level; of a dark prediction, whether not a single photon came.
fn agrees(predicted: &Slices, tally: &PlaneTally, p_value: Option<f64>, level: f64) -> bool {
    let dark = predicted.half.iter().all(|f| f.norm_sqr() <= 0.0);
    if dark {
        tally.inside == 0
    } else {
        p_value.is_some_and(|p| p >= level)
    }
}

/// Photons that bring the noise to where agreement means something.
fn photons_needed(emitted: u64, noise: f64) -> f64 {
    (emitted as f64 * (noise / RESOLVED).powi(2)).ceil()
}

/// How far measured and predicted are apart, over the independent frequencies.
struct Agreement {
    /// Σ|S − F|², Σσ² and Σ|F|².
    difference: f64,
    noise: f64,
    predicted: f64,
    excess_squared_error: Option<f64>,
    noise_floor_db: Option<f64>,
}

impl Agreement {
    fn new(residuals: &Residuals, variance: &Array3<f64>, prediction: &Slices) -> Self {
        let predicted = residuals.sum(&prediction.half, variance, |f, _| f.norm_sqr());
        let noise = residuals.sum(&prediction.half, variance, |_, v| *v);
        let difference = residuals.sum(&residuals.mean(), variance, |m, _| m.norm_sqr());
        let peak = prediction
            .half
            .iter()
            .map(|f| f.norm_sqr())
            .fold(0.0, f64::max);
        let mean_noise = noise / residuals.frequencies() as f64;
        Self {
            difference,
            noise,
            predicted,
            excess_squared_error: (predicted > 0.0).then(|| residuals.squared_error() / predicted),
            noise_floor_db: (peak > 0.0 && noise > 0.0).then(|| 10.0 * (mean_noise / peak).log10()),
        }
    }

    fn relative(&self, squared: f64) -> Option<f64> {
        (self.predicted > 0.0).then(|| (squared.abs() / self.predicted).sqrt().copysign(squared))
    }

    fn relative_error(&self) -> Option<f64> {
        self.relative(self.difference)
    }

    fn noise_limit(&self) -> Option<f64> {
        self.relative(self.noise)
    }

    fn excess(&self) -> Option<f64> {
        self.relative(self.difference - self.noise)
    }

    fn verdict(&self, agrees: bool) -> Verdict {
        // With noise like that batches hold a handful of photons, and their residuals are not symmetric.
        match (
            self.noise_limit().is_some_and(|noise| noise > RESOLVED),
            agrees,
        ) {
            (true, _) => Verdict::Undecided,
            (false, true) => Verdict::Pass,
            (false, false) => Verdict::Fail,
        }
    }

    /// Whether the error of the prediction's own quadrature leaves nothing to be decided: agreement, if it is not below the noise; disagreement, if
    /// it may be all of that.
    fn is_blurred(&self, quadrature: Option<f64>, agrees: bool) -> bool {
        let (Some(error), Some(noise), Some(excess)) =
            (quadrature, self.noise_limit(), self.excess())
        else {
            return false;
        };
        if agrees {
            error > BLURRED * noise
        } else {
            error > excess.max(QUADRATURE * noise)
        }
    }
}

/// The largest error of a quadrature that cannot be seen, and goes without a warning, as a share of the noise: it adds a thousandth to χ².
const QUADRATURE: f64 = 1.0 / 30.0;

/// The highest predicted power on the border of the grid that goes without a warning, below the peak.
const BORDER: f64 = 1e-2;

/// Limits of the measurement, in words.
fn warnings(
    predicted: &Array2<f64>,
    grid: &SliceGrid,
    quadrature: Option<(f64, f64)>,
) -> Vec<String> {
    let mut warnings = Vec::new();
    if let Some((error, noise)) = quadrature.filter(|(error, noise)| *error > QUADRATURE * noise) {
        warnings.push(format!(
            "the prediction's quadrature may be off by {:.4} % of the spectrum; noise is {:.4} %",
            100.0 * error,
            100.0 * noise
        ));
    }
    let peak = predicted.iter().copied().fold(0.0, f64::max);
    if peak <= 0.0 {
        warnings.push("no light is predicted in this window".to_owned());
    }
    let at = |axis: Axis| {
        let first = predicted.index_axis(axis, 0);
        first.iter().copied().fold(0.0, f64::max)
    };
    for (name, axis, max) in [
        ("rho", Axis(0), grid.rho.max()),
        ("nu", Axis(1), grid.nu.max()),
    ] {
        let border = at(axis);
        if border > BORDER * peak {
            warnings.push(format!(
                "the spectrum goes on beyond |{name}| = {}, where it is {:.0} dB below its peak; bandwidths \
                 count what is inside",
                tidy(max),
                10.0 * (peak / border).log10()
            ));
        }
    }
    warnings
}
