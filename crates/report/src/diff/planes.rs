//! Tests one plane of two results, and describes the outcome.

use super::pairs::{PairedNumbers, Pairs, ParameterDiff};
use super::stored::{StoredPlane, StoredResult, StoredSlices};
use etendue_compare::{Class, Estimate, MIN_PHOTONS_PER_BATCH, Sample, TwoSamples, Verdict, pull};
use etendue_field::{Complex, SliceGrid, percent, tidy};
use etendue_store::Failure;
use etendue_store::fields::{FieldChange, differences};
use ndarray::Array3;
use serde_json::{Value, json};
use std::f64::consts::SQRT_2;

/// The word for slices in a list of what differs.
pub(super) const SLICES: &str = "slices";

/// A plane that at least one of two results has.
#[derive(Debug)]
pub(super) struct PlaneDiff {
    pub(super) name: String,
    pub(super) found: PlaneDifference,
}

/// The outcome for a plane.
#[derive(Debug)]
pub(super) enum PlaneDifference {
    /// One result lacks the plane: the first result if the number is 0, and the second result if
    /// the number is 1.
    Missing(usize),
    /// The two results measure the plane in different units, at different frequencies or in
    /// different windows, as the text describes.
    Unlike(String),
    /// Both results have the plane and record the same quantity.
    Compared(Box<Compared>),
}

/// A plane that both results have.
#[derive(Debug)]
pub(super) struct Compared {
    pub(super) test: TwoSamples,
    /// Numbers of the test in pairs; `None` if the results have independent noise.
    pub(super) pairs: Option<PairedNumbers>,
    pub(super) parameters: Vec<ParameterDiff>,
    pub(super) slopes: [Option<Estimate>; 2],
    /// The difference of the predictions; `None` if a result has no prediction.
    pub(super) prediction: Option<PredictionDiff>,
    /// The reason why the plane is undecided although the tests find no difference.
    unresolved: Option<String>,
    /// The reason why the outcome of the tests cannot be trusted.
    invalid: Option<String>,
    /// Whether the two results come from the same photons, and so have the same numbers.
    pub(super) is_identical: bool,
}

/// The difference of two predictions.
#[derive(Debug)]
pub(super) struct PredictionDiff {
    /// The relative difference ‖F_A − F_B‖, divided by the larger of the two norms.
    pub(super) difference: f64,
    /// Whether the two predictions are for the same scene but differ by more than their errors.
    pub(super) is_wrong: bool,
}

/// If the relative difference between two numbers is below this limit, they are assumed to differ
/// only because their sums are rounded differently.
pub(super) const ROUNDING: f64 = 1e-12;
/// The largest accepted relative difference between a closed form in two versions of the program.
/// Two versions may add its terms in different orders, so the limit allows for rounding errors of
/// the largest terms.
const CLOSED_FORM: f64 = 1e-9;
/// The difference between two predictions counts as real if it exceeds this number of combined
/// standard errors. The difference is a norm over all frequencies, so its random variation is
/// small.
const APART: f64 = 3.0;
/// The smallest p-value of the rest of a change with which one parameter is said to explain it.
const EXPLAINED: f64 = 0.05;
/// The probability that independent noise of any plane is mistaken for the noise of shared photons.
const SHARED: f64 = 1e-4;

impl PlaneDiff {
    pub(super) fn compared(&self) -> Option<&Compared> {
        match &self.found {
            PlaneDifference::Compared(compared) => Some(compared),
            _ => None,
        }
    }

    /// The name of the plane with its comparison, if it is compared.
    pub(super) fn named(&self) -> Option<(&String, &Compared)> {
        Some((&self.name, self.compared()?))
    }

    pub(super) fn verdict(&self, level: f64) -> Verdict {
        self.compared()
            .map_or(Verdict::Undecided, |compared| compared.verdict(level))
    }

    /// The reason why the plane is undecided, or `None` if it is decided.
    pub(super) fn undecided(&self, level: f64) -> Option<String> {
        match &self.found {
            PlaneDifference::Missing(0) => Some("only the second result has this plane".to_owned()),
            PlaneDifference::Missing(_) => Some("only the first result has this plane".to_owned()),
            PlaneDifference::Unlike(why) => Some(why.clone()),
            PlaneDifference::Compared(compared) => {
                let reason = compared.invalid.as_ref().or(compared.unresolved.as_ref());
                let is_open = compared.verdict(level) == Verdict::Undecided;
                reason.filter(|_| is_open).cloned()
            }
        }
    }
}

impl Compared {
    /// The parameters that are tested, with their differences in standard errors.
    pub(super) fn pulls(&self) -> impl Iterator<Item = &ParameterDiff> {
        self.parameters.iter().filter(|_| self.invalid.is_none())
    }

    /// Returns descriptions of the quantities that differ by more than noise.
    pub(super) fn differing(&self, level: f64) -> Vec<String> {
        let mut differing = Vec::new();
        if self.invalid.is_none() && self.test.p_value.is_some_and(|p| p < level) {
            differing.push(SLICES.to_owned());
        }
        let pulls = || self.pulls().filter(|parameter| parameter.pull.1 < level);
        // A change of one parameter changes the others, each of which is measured as if it were the
        // only one.
        let explains =
            |parameter: &&ParameterDiff| parameter.p_rest.is_some_and(|p| p >= EXPLAINED);
        let is_explained = pulls().any(|parameter| explains(&parameter));
        let named = pulls().filter(|parameter| !is_explained || explains(parameter));
        differing.extend(named.map(|parameter| parameter.name.clone()));
        let is_wrong = self.prediction.as_ref().is_some_and(|of| of.is_wrong);
        differing.extend(is_wrong.then(|| "prediction".to_owned()));
        differing
    }

    fn verdict(&self, level: f64) -> Verdict {
        if !self.differing(level).is_empty() {
            Verdict::Fail
        } else if self.invalid.is_some() || self.unresolved.is_some() {
            Verdict::Undecided
        } else {
            Verdict::Pass
        }
    }
}

/// All planes of two results, in the order of the first result.
pub(super) fn of_results(
    a: &StoredResult,
    b: &StoredResult,
    is_one_scene: bool,
    is_paired: bool,
) -> Result<Vec<PlaneDiff>, Failure> {
    let common = a.index.planes.iter().map(|plane| {
        let found = match b.plane(&plane.name) {
            Some(other) => {
                let pair = ResultPair {
                    a,
                    b,
                    is_one_scene,
                    is_paired,
                };
                pair.found(plane, other)?
            }
            None => PlaneDifference::Missing(1),
        };
        let name = plane.name.clone();
        Ok(PlaneDiff { name, found })
    });
    let mut planes: Vec<PlaneDiff> = common.collect::<Result<_, Failure>>()?;
    let is_added = |plane: &&StoredPlane| a.plane(&plane.name).is_none();
    let added = b.index.planes.iter().filter(is_added);
    planes.extend(added.map(|plane| PlaneDiff {
        name: plane.name.clone(),
        found: PlaneDifference::Missing(0),
    }));
    Ok(planes)
}

/// Two results, which may belong to different scenes.
struct ResultPair<'a> {
    a: &'a StoredResult,
    b: &'a StoredResult,
    is_one_scene: bool,
    is_paired: bool,
}

impl ResultPair<'_> {
    fn found(&self, of_a: &StoredPlane, of_b: &StoredPlane) -> Result<PlaneDifference, Failure> {
        let (a, b) = (self.a.slices(of_a)?, self.b.slices(of_b)?);
        if let Some(why) = self.unlike(&of_a.name, &a, &b) {
            return Ok(PlaneDifference::Unlike(why));
        }
        let (test, pairs, parameters) = if self.is_paired {
            let pairs = Pairs::read([self.a, self.b], &of_a.name, [&a, &b])?;
            let parameters = pairs.parameters(&self.a.parameters(&of_a.name, &a)?);
            let (test, numbers) = pairs.test();
            (test, Some(numbers), parameters)
        } else {
            let test = TwoSamples::new(&a.grid, &a.sample, &b.sample);
            (test, None, self.parameters(of_a, of_b))
        };
        let few = pairs.as_ref().and_then(|pairs| pairs.few.clone());
        let is_identical = self.has_one_seed() && test.difference <= ROUNDING;
        let compared = Compared {
            parameters,
            pairs,
            slopes: [
                of_a.slope.estimate(self.a.index.batches.len()),
                of_b.slope.estimate(self.b.index.batches.len()),
            ],
            prediction: self.prediction([of_a, of_b], &a, &b),
            invalid: (!is_identical).then(|| self.invalid([&a, &b])).flatten(),
            unresolved: (!is_identical)
                .then(|| few.or_else(|| self.unresolved(&test)))
                .flatten(),
            is_identical,
            test,
        };
        Ok(PlaneDifference::Compared(Box::new(compared)))
    }

    /// Checks whether both results have the same method, seed, photons and batches. Results with
    /// equal settings share the photons of everything that their scenes have in common.
    fn has_one_seed(&self) -> bool {
        let [a, b] = [self.a, self.b].map(|result| {
            let index = &result.index;
            (&index.method, index.seed, index.photons, &index.batches)
        });
        a == b
    }

    /// Why the slices of the two results cannot be subtracted.
    fn unlike(&self, name: &str, a: &StoredSlices, b: &StoredSlices) -> Option<String> {
        let [left, right] = [self.a, self.b].map(|result| view(&result.index.scene_file, name));
        if let Some(FieldChange { field, values }) = differences(&left, &right).into_iter().next() {
            return Some(format!("the field {field} is {}", values.join(" and ")));
        }
        let names = ["azimuths", "frequencies ρ", "frequencies ν"];
        let mut axes = names.iter().zip(a.axes.iter().zip(&b.axes));
        let (name, (a, b)) = axes.find(|(_, (a, b))| a != b)?;
        let brief = |axis: &ndarray::Array1<f64>| {
            let last = axis.iter().copied().fold(0.0, f64::max);
            format!("{} up to {}", axis.len(), tidy(last))
        };
        Some(format!("the {name} differ: {} and {}", brief(a), brief(b)))
    }

    fn parameters(&self, a: &StoredPlane, b: &StoredPlane) -> Vec<ParameterDiff> {
        let batches = [self.a, self.b].map(|result| result.index.batches.len());
        let each = a.parameters.iter().filter(|p| p.is_determined());
        let each = each.filter_map(|of_a| {
            let mut others = b.parameters.iter().filter(|p| p.is_determined());
            let of_b = others.find(|p| p.name == of_a.name && p.unit == of_a.unit)?;
            let estimates = [
                of_a.number.estimate(batches[0])?,
                of_b.number.estimate(batches[1])?,
            ];
            Some(ParameterDiff {
                name: of_a.name.clone(),
                unit: of_a.unit.clone(),
                pull: pull(estimates[0], estimates[1])?,
                p_rest: None,
                estimates,
            })
        });
        each.collect()
    }

    fn prediction(
        &self,
        planes: [&StoredPlane; 2],
        a: &StoredSlices,
        b: &StoredSlices,
    ) -> Option<PredictionDiff> {
        let (of_a, of_b) = a.predicted.as_ref().zip(b.predicted.as_ref())?;
        let difference = apart(&a.grid, of_a, of_b);
        let error = |plane: &StoredPlane| plane.quadrature_error.unwrap_or(0.0).powi(2);
        let error: f64 = planes.into_iter().map(error).sum();
        // At a plane of the class `reference`, the prediction is also a measurement.
        let reference = Class::Reference.to_string();
        let is_reference = planes.iter().any(|plane| plane.class == reference);
        let allowed = CLOSED_FORM.max(APART * error.sqrt());
        Some(PredictionDiff {
            difference,
            is_wrong: self.is_one_scene && !is_reference && difference > allowed,
        })
    }

    /// The reason why the outcome of the tests cannot be trusted for these photons, if
    /// there is one.
    fn invalid(&self, slices: [&StoredSlices; 2]) -> Option<String> {
        for (slices, result) in slices.into_iter().zip([self.a, self.b]) {
            let folder = result.folder().display();
            let Sample {
                sigma, noise_dof, ..
            } = &slices.sample;
            if noise_dof.is_none() && sigma.iter().any(|sigma| *sigma > 0.0) {
                return Some(format!(
                    "{folder} has no noise_dof, because an older version of etendue wrote it; run its scene again"
                ));
            }
            let each = slices.in_window as f64 / result.index.batches.len() as f64;
            // If one result has no light at the plane, only the photons of the other result are
            // checked.
            if slices.in_window > 0 && each < MIN_PHOTONS_PER_BATCH {
                return Some(format!(
                    "{folder} has {} photons in its window, too few for a test",
                    slices.in_window
                ));
            }
            if let Some(each) = carried_by(&slices.sample, &slices.grid) {
                return Some(format!(
                    "a few photons carry most of the light of {folder}: each batch is as noisy as a batch of only {each:.1} equal photons"
                ));
            }
        }
        None
    }

    /// The reason why the results may differ even though the test detects no difference.
    fn unresolved(&self, test: &TwoSamples) -> Option<String> {
        let [a, b] = [self.a, self.b].map(|result| &result.index);
        let [apart, noise] = [test.difference, test.noise].map(|share| percent(share, 3));
        let planes = a.planes.len().max(1) as f64;
        if test.p_shared.is_some_and(|p| p < SHARED / planes) {
            let seeds = if a.seed == b.seed {
                format!(
                    "both results have seed {}, and share photons; run both with --save batches, or one of them with another seed",
                    a.seed
                )
            } else {
                "the results share photons, or their noise is overstated; run one of them with another seed".to_owned()
            };
            return Some(format!(
                "the results differ by {apart}, but results with independent noise would differ by {noise}: {seeds}"
            ));
        }
        let resolution = [a, b].map(|r| r.scene_file["run"]["resolution"].as_f64());
        // The noise of the difference between two results is √2 times the noise of each result.
        let resolution = SQRT_2 * resolution.into_iter().flatten().fold(0.0, f64::max);
        (test.noise > resolution).then(|| {
            let resolution = percent(resolution, 3);
            format!("noise is {noise} of the spectrum; the limit is {resolution}, which is √2 times the resolution of the scene")
        })
    }
}

/// A number of photons per batch. This many photons of equal weight would vary as much as
/// the light of this sample. Returns `None` if this number is so large that no batch would be
/// empty. `etendue_compare` applies the same rule to a single run.
fn carried_by(sample: &Sample, grid: &SliceGrid) -> Option<f64> {
    let zero = [0, 0, grid.nu.half];
    let batches = sample.batches as f64;
    let [light, sigma] = [sample.mean[zero].re, sample.sigma[zero]];
    let each = light * light / (batches * sigma * sigma);
    (sigma > 0.0 && each < libm::log(batches)).then_some(each)
}

/// ‖a − b‖ divided by the larger norm, or 0 if both norms are 0.
fn apart(grid: &SliceGrid, a: &Array3<Complex>, b: &Array3<Complex>) -> f64 {
    let sample = |mean: &Array3<Complex>| Sample {
        mean: mean.clone(),
        sigma: Array3::zeros(mean.raw_dim()),
        noise_dof: None,
        batches: 3,
    };
    TwoSamples::new(grid, &sample(a), &sample(b)).difference
}

/// The definition of a plane's slices: its window, quantity and coordinates.
pub(super) fn view(scene_file: &Value, name: &str) -> Value {
    let planes = scene_file["planes"].as_array();
    let mut planes = planes.into_iter().flatten();
    let plane = planes.find(|plane| plane["name"] == name);
    let plane = plane.unwrap_or(&Value::Null);
    let own = &plane["window"];
    let window = if own.is_null() {
        &scene_file["window"]
    } else {
        own
    };
    // By default, the profile along y is the profile along x, and the profile along v is the
    // profile along u.
    let profile = |name: &str, along: &str| {
        let own = &window[name];
        if own.is_null() {
            window[along].clone()
        } else {
            own.clone()
        }
    };
    json!({
        "window": {
            "x": window["x"], "y": profile("y", "x"),
            "u": window["u"], "v": profile("v", "u"),
        },
        "quantity": plane["quantity"],
        "orientation": plane["orientation"],
    })
}
