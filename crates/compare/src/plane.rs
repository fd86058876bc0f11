//! Compares a plane of a measurement with its prediction.

use crate::agreement::{Agreement, UNSEEN};
use crate::first_order::FirstOrderReport;
use crate::full_radial::FullRadialComparison;
use crate::heavy_rays::too_few;
use crate::hint::hint;
use crate::noise::noise_dof;
use crate::power::PowerReport;
use crate::prediction::Prediction;
use crate::radial::RadialTest;
use crate::report::{Covariance, HighFrequencyShare, Pair, PlaneReport, WedgeShare};
use crate::residuals::{Residuals, largest, of_transform};
use crate::score::{ParameterReport, score};
use crate::variation::{bandwidth, variation};
use crate::verdict::{Test, Verdict};
use etendue_field::{SliceGrid, Slices, VirtualPlane, brief, percent};
use etendue_spectrum::estimate::{self, ProjectionEstimate, TooFewBatches};
use etendue_spectrum::moments::{high_frequency_share, second_moment, shear_slope, wedge_share};
use etendue_spectrum::{CrossPower, Measurement, RadialPower};
use ndarray::{Array2, Array3, ArrayView2, Axis};
use std::borrow::Cow;

/// The comparison of a plane: the report, and the arrays from which the report is computed.
#[derive(Clone, Debug)]
pub struct PlaneComparison {
    /// Every number, and the verdict.
    pub report: PlaneReport,
    /// The measured slices: the mean over batches.
    pub measured: Slices,
    /// The predicted slices. If the light field is zero, they are zero, without rounding errors.
    pub predicted: Slices,
    /// Standard deviation of |S − F|, [azimuth, ρ ≥ 0, ν].
    pub sigma: Array3<f64>,
    /// Standard deviation of |S| alone, with the same axes. This deviation differs from `sigma`
    /// only where the prediction has replicates, which have noise of their own.
    pub measured_sigma: Option<Array3<f64>>,
    /// The measured radial spectrum.
    pub radial: RadialPower,
    /// The predicted radial spectrum, [ρ, ν].
    pub predicted_radial: Array2<f64>,
    /// Standard deviation of measured minus predicted radial power, [ρ, ν], if the prediction is
    /// true.
    pub radial_sigma: Array2<f64>,
    /// |S − F₁|², averaged over the azimuths, [ρ, ν], where F₁ are the slices of the first-order
    /// chain; `None` where there is no chain.
    pub off_chain: Option<Array2<f64>>,
    /// The measured light field in (x, u).
    pub projection: ProjectionEstimate,
    /// The full radial spectrum, if the light field was put on a 4D grid and has a prediction.
    pub full_radial: Option<FullRadialComparison>,
}

/// A field with less than this share of the unblocked light is predicted to be dark. A closed form
/// is a difference of transforms as large as the unblocked light, and has an error of 10⁻¹⁵ of that
/// light.
const DARK: f64 = 1e-12;

/// The p-value assumes symmetric residuals. If the noise exceeds this limit, the residuals come
/// from few photons and are not symmetric.
const MAX_HANDFUL_NOISE: f64 = 0.25;
/// The smallest number of photons per batch. With this number, one in 3,000 batches is empty.
pub const MIN_PHOTONS_PER_BATCH: f64 = 8.0;

/// Compares plane `index` of a measurement with its prediction.
///
/// # Errors
/// Returns an error if the measurement has too few batches for standard errors.
pub fn compare(
    measurement: &Measurement,
    index: usize,
    prediction: &Prediction,
    test: &Test,
) -> Result<PlaneComparison, TooFewBatches> {
    let estimate = estimate::slices(measurement, index)?;
    let predicted = without_rounding(prediction);
    let residuals = Residuals::between(measurement, index, &predicted, &prediction.replicates);
    let power = CrossPower::new(measurement, index)?;
    let replicates = if prediction.is_statistical() {
        let azimuths = 0..predicted.grid.azimuths;
        Some(CrossPower::of_replicates(&prediction.replicates, azimuths)?)
    } else {
        None
    };
    let (variance, measured_variance, predicted_radial) = match &replicates {
        Some(replicates) => {
            let variance = residuals.variance();
            (variance, Some(estimate.variance), replicates.power())
        }
        None => (estimate.variance, None, predicted.radial_power()),
    };
    let sides = ComparedSides {
        measurement,
        index,
        prediction,
        predicted: &predicted,
        residuals: &residuals,
        variance: &variance,
        power: &power,
        replicates: replicates.as_ref(),
        predicted_radial: &predicted_radial,
    };
    let mut report = sides.report(&sides.judged(test))?;
    if report.exact_verdict() == Verdict::Fail && !test.accepts(report.p_value) {
        let plane = (measurement, index);
        let replicates = &prediction.replicates;
        let (measured, seed) = (&estimate.mean, test.seed);
        let hint = hint(plane, measured, &predicted, replicates, &variance, seed);
        report.warnings.extend(hint);
    }
    let measured_sigma = measured_variance.map(|variance| variance.mapv(f64::sqrt));
    let off_chain = prediction.first_order.as_ref().map(|chain| Slices {
        half: &estimate.mean.half - &chain.slices.half,
        ..estimate.mean
    });
    Ok(PlaneComparison {
        report,
        off_chain: off_chain.map(|off| off.radial_power()),
        measured: estimate.mean,
        radial: power.radial(),
        radial_sigma: residuals.radial_sigma(&predicted, &variance),
        sigma: variance.mapv(f64::sqrt),
        measured_sigma,
        predicted_radial,
        predicted,
        projection: estimate::projection(measurement, index)?,
        full_radial: None,
    })
}

/// The measurement and the prediction of a plane, with their difference.
struct ComparedSides<'a> {
    measurement: &'a Measurement,
    index: usize,
    prediction: &'a Prediction,
    predicted: &'a Slices,
    residuals: &'a Residuals,
    /// The variance of the mean residual, including the noise of the prediction.
    variance: &'a Array3<f64>,
    power: &'a CrossPower<'a>,
    /// The power of a prediction that has replicates.
    replicates: Option<&'a CrossPower<'a>>,
    predicted_radial: &'a Array2<f64>,
}

/// The tests of a plane: of its slices, and of its radial spectrum.
struct PlaneTests {
    p_value: Option<f64>,
    chi2_per_dof: Option<f64>,
    radial: PowerReport,
}

impl PlaneTests {
    fn are_passed(&self, test: &Test) -> bool {
        test.accepts(self.p_value) && test.accepts(self.radial.p_value)
    }
}

/// The outcome of a comparison.
struct Judgement {
    agreement: Agreement,
    tests: PlaneTests,
    first_order: Option<FirstOrderReport>,
    verdict: Verdict,
    photons_needed: Option<f64>,
    undecided_reason: Option<String>,
}

impl ComparedSides<'_> {
    fn judged(&self, test: &Test) -> Judgement {
        let agreement = Agreement::new(self.residuals, self.variance, self.predicted);
        let mut tests = self.tests(None, test);
        if !tests.are_passed(test) {
            // The error of the photons' transform may exceed their noise.
            let within = self.tests(Some(0.0), test);
            if within.are_passed(test) {
                tests = within;
            }
        }
        let agrees = if self.predicted.is_dark() {
            self.is_dark()
        } else {
            tests.are_passed(test)
                || agreement.is_explained(self.prediction)
                || self.is_excused(test)
        };
        let photons_needed = self.photons_needed(&agreement, agrees, test);
        let undecided_reason = self.undecided_reason(&agreement, agrees, photons_needed, test);
        let verdict = match (&undecided_reason, agrees) {
            (Some(_), _) => Verdict::Undecided,
            (None, true) => Verdict::Pass,
            (None, false) => Verdict::Fail,
        };
        let first_order = self.prediction.first_order.as_ref();
        let exact = (self.predicted, self.residuals, verdict);
        let first_order =
            first_order.map(|f| f.report(self.measurement, self.index, exact, test.seed));
        let has_wrong_map = first_order.as_ref().map(|f| f.verdict) == Some(Verdict::Fail);
        Judgement {
            agreement,
            tests,
            first_order,
            photons_needed: photons_needed.filter(|_| undecided_reason.is_some()),
            undecided_reason,
            verdict: if has_wrong_map {
                Verdict::Fail
            } else {
                verdict
            },
        }
    }

    /// Why the comparison is undecided, in words; `None` where it is decided.
    fn undecided_reason(
        &self,
        agreement: &Agreement,
        agrees: bool,
        photons_needed: Option<f64>,
        test: &Test,
    ) -> Option<String> {
        let (inside, emitted) = (self.inside(), self.measurement.emitted());
        let needs = photons_needed.map(|needed| format!("; needs {:.0e} photons", rounded(needed)));
        let needs = needs.unwrap_or_default();
        let percent = |share: f64| percent(share, 3);
        let noise = agreement.resolution();
        let error = self.prediction.systematic_error().unwrap_or(0.0);
        if self.predicted.is_dark() {
            // A closed form can prove that no light arrives, but a search by rays cannot.
            self.prediction.is_statistical().then(|| {
                format!(
                    "no ray of the prediction reached the window, and {inside} of {emitted} photons reached it. If no photon reached the window, the share of photons that can reach it is below 3 in {emitted} with 95 % confidence"
                )
            })
        } else if inside == 0 {
            Some(format!("none of {emitted} photons reached the window"))
        } else if self.has_dark_batch() {
            let batches = self.measurement.batches().len();
            Some(format!(
                "too few photons in the window, {inside} in {batches} batches: at least one batch has none{needs}"
            ))
        } else if self.has_dark_replicate() {
            let replicates = self.prediction.replicates.len();
            Some(format!(
                "too few rays of the prediction: at least one of its {replicates} independent estimates found no light{needs}"
            ))
        } else if let Some(each) = self.uneven(agrees) {
            Some(format!(
                "a few photons, or a few rays of the prediction, carry most of the light: each batch is as noisy as a batch of only {each:.1} equal photons or rays, which are too few for a test{needs}"
            ))
        } else if agrees && error > test.resolution {
            let error = percent(error);
            let what = match self.prediction.mesh_error {
                None => "because of its quadrature, the prediction may be wrong",
                Some(_) => "because of the coarse mesh, photons and the prediction may differ",
            };
            Some(format!(
                "{what} by {error} of the spectrum, and noise is {}; more photons do not help",
                percent(noise)
            ))
        } else if agrees && noise > test.resolution {
            let resolution = percent(test.resolution);
            Some(format!(
                "noise is {} of the spectrum, above the resolution of {resolution}{needs}",
                percent(noise)
            ))
        } else if noise > test.resolution.max(MAX_HANDFUL_NOISE) {
            Some(format!(
                "too few photons for a meaningful p-value: noise is {} of the spectrum{needs}",
                percent(noise)
            ))
        } else {
            None
        }
    }

    /// Checks whether photons agree with any spectrum near the prediction, for example where the
    /// photons have almost no noise. At each frequency, this spectrum may differ from the
    /// prediction by the possible error of a quadrature or of the photons' transform.
    fn is_excused(&self, test: &Test) -> bool {
        let error = self.prediction.systematic_error();
        error.is_some_and(|error| self.tests(Some(error), test).are_passed(test))
    }

    /// Tests the difference between measurement and prediction, or between the measurement and the
    /// closest spectrum within a relative error of the prediction
    /// ([`forgiving`](Residuals::forgiving)).
    fn tests(&self, within: Option<f64>, test: &Test) -> PlaneTests {
        let forgiven = within.map(|error| self.residuals.forgiven(self.predicted, error));
        let tested = match &forgiven {
            Some(forgiven) => Cow::Owned(self.residuals.without(forgiven)),
            None => Cow::Borrowed(self.residuals),
        };
        let measured = (self.measurement, self.index);
        let radial = RadialTest::new(measured, self.predicted, &self.prediction.replicates);
        PlaneTests {
            p_value: tested.p_value(test.seed),
            chi2_per_dof: tested.chi2_per_dof(self.variance),
            radial: radial.report(forgiven.as_ref(), test.seed),
        }
    }

    /// The number of photons with which the comparison would be decided. Returns `None`
    /// where this number is not known, or where more photons do not help.
    fn photons_needed(&self, agreement: &Agreement, agrees: bool, test: &Test) -> Option<f64> {
        let (inside, emitted) = (self.inside(), self.measurement.emitted());
        let batches = self.measurement.batches().len() as f64;
        let for_batches = MIN_PHOTONS_PER_BATCH * batches / inside as f64;
        if self.predicted.is_dark() || inside == 0 {
            None
        } else if self.has_dark_batch() {
            // The number with which no batch is empty; a run with it will tell the noise.
            Some((emitted as f64 * for_batches).ceil())
        } else if self.has_dark_replicate() {
            // If each of n replicates has m rays on average, n e⁻ᵐ replicates are empty.
            let all = self.prediction.replicates.len() as f64;
            let empty = self.prediction.replicates.iter().filter(|r| r.is_dark());
            let each = libm::log(all / empty.count() as f64);
            let more = for_batches.max(MIN_PHOTONS_PER_BATCH / each);
            let more = more.is_finite().then(|| (emitted as f64 * more).ceil());
            let less_noise = agreement.photons_needed(emitted, self.prediction, test);
            more.into_iter().chain(less_noise).max_by(f64::total_cmp)
        } else {
            let uneven = self.uneven(agrees);
            let more = uneven.map(|each| (emitted as f64 * MIN_PHOTONS_PER_BATCH / each).ceil());
            let less_noise = agreement.photons_needed(emitted, self.prediction, test);
            more.into_iter().chain(less_noise).max_by(f64::total_cmp)
        }
    }

    /// How many rays of equal weight would vary as much as the rays of a batch, or as the
    /// rays of a replicate of the prediction. Returns `None` if this number is large enough for a
    /// test, or if measurement and prediction agree.
    fn uneven(&self, agrees: bool) -> Option<f64> {
        let batches = self.measurement.at_plane(self.index);
        let measured = too_few(batches.map(|batch| &batch.slices));
        let predicted = too_few(self.prediction.replicates.iter());
        let fewest = measured.into_iter().chain(predicted);
        fewest.min_by(f64::total_cmp).filter(|_| !agrees)
    }

    /// Checks whether photons brought no light, or so little light that it cannot be distinguished
    /// from rounding errors of the prediction.
    fn is_dark(&self) -> bool {
        largest(&self.residuals.mean()) <= self.prediction.unblocked * DARK
    }

    fn inside(&self) -> u64 {
        self.measurement.tally(self.index).inside
    }

    /// Checks whether a batch of photons found no light. With so few photons, the errors are not
    /// symmetric, and no conclusion is possible.
    fn has_dark_batch(&self) -> bool {
        let mut batches = self.measurement.at_plane(self.index);
        batches.any(|batch| batch.tally.inside == 0)
    }

    /// Checks whether a replicate of the prediction found no light.
    fn has_dark_replicate(&self) -> bool {
        self.prediction.replicates.iter().any(Slices::is_dark)
    }

    fn report(&self, judged: &Judgement) -> Result<PlaneReport, TooFewBatches> {
        let plane = &self.measurement.planes()[self.index];
        let tally = self.measurement.tally(self.index);
        let (grid, prediction) = (&plane.grid, self.prediction);
        let agreement = &judged.agreement;
        // Batches without photons do not tell the noise.
        let tells_noise = !self.has_dark_batch();
        let noise = agreement.noise_limit().filter(|_| tells_noise);
        Ok(PlaneReport {
            name: plane.name.clone(),
            class: prediction.class,
            chain: prediction.steps.clone(),
            // The error of a dark field is a ratio of rounding errors.
            quadrature_error: prediction.error().filter(|_| noise.is_some()),
            frame: plane.frame,
            distance: plane.distance,
            crossed: tally.crossed,
            in_window: tally.inside,
            outside_window: tally.outside,
            relative_error: agreement.relative_error(),
            noise_limit: noise,
            excess: agreement.excess().filter(|_| tells_noise),
            excess_squared_error: agreement.excess_squared_error.filter(|_| tells_noise),
            noise_floor_db: agreement.noise_floor_db.filter(|_| tells_noise),
            noise_dof: noise_dof(self.measurement, self.index)?,
            chi2_per_dof: judged.tests.chi2_per_dof.filter(|_| tells_noise),
            p_value: judged.tests.p_value.filter(|_| tells_noise),
            radial: tells_noise.then_some(judged.tests.radial),
            parameters: if tells_noise {
                self.parameters()
            } else {
                Vec::new()
            },
            slope: self.slope(grid),
            spectral_moments: [[2, 0], [1, 1], [0, 2]]
                .map(|powers| self.pair(|p| second_moment(p, grid, powers))),
            bandwidth_95: bandwidth(self.power, self.replicates, self.predicted),
            variation_95: variation(self.measurement, self.index, prediction, self.predicted)?,
            covariance: covariance(self.measurement, self.index, prediction)?,
            full_radial: None,
            wedge_share: self.wedge_shares(plane),
            high_frequency_share: self.high_frequency_shares(grid),
            photons_needed: judged.photons_needed,
            undecided: judged.undecided_reason.clone(),
            verdict: judged.verdict,
            first_order: judged.first_order.clone().filter(|_| tells_noise),
            warnings: warnings(
                self.predicted_radial,
                grid,
                prediction.systematic_error().zip(noise),
            ),
        })
    }

    fn parameters(&self) -> Vec<ParameterReport> {
        let parameters = self.prediction.parameters.iter();
        let numerical = self.numerical_error();
        parameters
            .filter_map(|parameter| score(self.residuals, self.variance, parameter, numerical))
            .collect()
    }

    /// ‖error‖ of a prediction by quadrature, over the independent frequencies.
    fn numerical_error(&self) -> f64 {
        let half = &self.predicted.half;
        let size = self.residuals.sum(half, half, |f, _| f.norm_sqr()).sqrt();
        self.prediction.systematic_error().unwrap_or(0.0) * size
    }

    /// The shear slope s = Σ P ρν / Σ P ρ². An error ‖dF‖ = ε ‖F‖ of the spectrum changes s
    /// by at most 2ε √(Σ P · Σ g² P), where g = ∂s/∂P = (ρν − s ρ²) / Σ P ρ² (Cauchy–Schwarz).
    fn slope(&self, grid: &SliceGrid) -> Pair {
        let pair = self.pair(|p| shear_slope(p, grid));
        let pair = Pair {
            error: pair.error.filter(|_| !self.has_dark_batch()),
            ..pair
        };
        let epsilon = self.prediction.systematic_error();
        let (Some(epsilon), Some(slope)) = (epsilon, pair.predicted) else {
            return pair;
        };
        let [mut all, mut along, mut squares] = [0.0; 3];
        for ((i, j), p) in self.predicted_radial.indexed_iter() {
            let (rho, nu) = (grid.rho.value(i), grid.nu.value(j));
            all += p;
            along += p * rho * rho;
            squares += p * (rho * nu - slope * rho * rho).powi(2);
        }
        let bound = 2.0 * epsilon * (all * squares).sqrt() / along;
        Pair {
            error: pair.error.map(|error| libm::hypot(error, bound)),
            ..pair
        }
    }

    fn high_frequency_shares(&self, grid: &SliceGrid) -> Vec<HighFrequencyShare> {
        let cuts = self.prediction.cuts.iter();
        let shares = cuts.map(|&cut| HighFrequencyShare {
            cut,
            share: self.pair(|p| high_frequency_share(p, grid, cut)),
        });
        shares.collect()
    }

    fn wedge_shares(&self, plane: &VirtualPlane) -> Vec<WedgeShare> {
        let Some([nearest, farthest]) = self.prediction.depth else {
            return Vec::new();
        };
        let share = |farthest: f64| WedgeShare {
            nearest,
            farthest,
            share: self.pair(|p| wedge_share(p, &plane.grid, &plane.window, [nearest, farthest])),
        };
        vec![share(farthest), share(plane.distance)]
    }

    /// Applies the same estimator to the measured and to the predicted radial power, and returns
    /// both results.
    fn pair(&self, of: impl Fn(ArrayView2<'_, f64>) -> Option<f64>) -> Pair {
        let measured = self.power.statistic(&of);
        let predicted = self.replicates.and_then(|power| power.statistic(&of));
        let noise = predicted.map_or(0.0, |p| p.error);
        Pair {
            measured: measured.map(|m| m.value),
            predicted: of(self.predicted_radial.view()),
            error: measured.map(|m| {
                let noise = libm::hypot(m.error, noise);
                libm::hypot(noise, self.transform_error(&of))
            }),
        }
    }

    /// Returns by how much the error of the fast transform may change a statistic of the power.
    /// The powers where ρν ≥ 0 change, so that the changes add up whether the statistic is even or
    /// odd in ρ; the other half of the powers changes the statistic as much.
    fn transform_error(&self, of: impl Fn(ArrayView2<'_, f64>) -> Option<f64>) -> f64 {
        let (still, grid) = (self.predicted_radial, &self.predicted.grid);
        let mut moved = still.clone();
        for (at, change) in of_transform(still).indexed_iter() {
            if grid.rho.value(at.0) * grid.nu.value(at.1) >= 0.0 {
                moved[at] += change;
            }
        }
        let change = of(moved.view()).zip(of(still.view()));
        change.map_or(0.0, |(moved, still)| 2.0 * (moved - still).abs())
    }
}

/// The second moments of the photons, and their prediction.
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

/// Adds a margin of a tenth and rounds up to one digit. The margin is necessary because the noise
/// of one run gives only an estimate of the number of photons that another run needs.
fn rounded(photons: f64) -> f64 {
    let wanted = 1.1 * photons;
    let unit = libm::pow(10f64, libm::log10(wanted.max(1.0)).floor());
    (wanted / unit).ceil() * unit
}

/// The predicted slices, set to zero where they are the rounding errors of a dark field.
fn without_rounding(prediction: &Prediction) -> Slices {
    let least = prediction.unblocked * DARK;
    if largest(&prediction.slices.half) <= least {
        Slices::zeros(prediction.slices.grid)
    } else {
        prediction.slices.clone()
    }
}

/// If the predicted power on the border of the grid exceeds this share of the peak, there is a
/// warning.
const BORDER: f64 = 1e-2;

/// The limits of the measurement, in words.
fn warnings(predicted: &Array2<f64>, grid: &SliceGrid, blur: Option<(f64, f64)>) -> Vec<String> {
    let mut warnings = Vec::new();
    if let Some((error, noise)) = blur.filter(|(error, noise)| *error > UNSEEN * noise) {
        warnings.push(format!(
            "the prediction may be off by {} of the spectrum; noise is {}",
            percent(error, 4),
            percent(noise, 4)
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
                "the spectrum extends beyond |{name}| = {}: there it is only {:.0} dB below its peak. Bandwidths cover only frequencies up to this limit",
                brief(max),
                10.0 * libm::log10(peak / border)
            ));
        }
    }
    warnings
}

impl PlaneComparison {
    /// Adds the full radial spectrum. A plane that would otherwise pass fails if the p-value of
    /// this spectrum is below the level of the test. However, it does not fail if a systematic
    /// error, which replicates do not show, may exceed the noise.
    pub fn add_full_radial(
        &mut self,
        full_radial: FullRadialComparison,
        prediction: &Prediction,
        test: &Test,
    ) {
        let report = &mut self.report;
        let numbers = full_radial.report;
        let disagrees = !test.accepts(numbers.power.p_value);
        let error = prediction.systematic_error().zip(report.noise_limit);
        let is_excused = error.is_some_and(|(error, noise)| error > UNSEEN * noise);
        report.full_radial = Some(numbers);
        if disagrees && !is_excused && report.exact_verdict() == Verdict::Pass {
            report.verdict = Verdict::Fail;
            if let Some(chain) = &mut report.first_order {
                chain.exact = Verdict::Fail;
            }
        }
        self.full_radial = Some(full_radial);
    }
}
