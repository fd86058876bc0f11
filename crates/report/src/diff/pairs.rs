//! Tests pairs: two results whose batches use the same random numbers.
//!
//! The photons of a batch are the same in both results until they meet what differs between the
//! scenes, so most of the noise cancels in the difference of two batches. The differences of all
//! batches are independent of each other.

use super::stored::{StoredResult, StoredSlices};
use etendue_compare::{
    Estimate, MIN_DIFFERING, PredictedParameter, Residuals, TwoSamples, pull, score,
};
use etendue_field::{Complex, Slices};
use etendue_store::Failure;

/// What a test in pairs finds at one plane, in addition to its [`TwoSamples`].
#[derive(Debug)]
pub(super) struct PairedNumbers {
    /// √Σ(σ_A² + σ_B²) divided by the larger of ‖A‖ and ‖B‖: the noise that the difference would
    /// have without pairs.
    pub(super) unpaired_noise: f64,
    /// The p-value of the hypothesis that the difference of the predictions is the true difference;
    /// `None` if a prediction is missing or has errors of its own, or if too few batches differ.
    pub(super) p_predicted: Option<f64>,
    /// The reason why the pairs give no errors.
    pub(super) few: Option<String>,
}

/// A parameter that both results measure.
#[derive(Debug)]
pub(super) struct ParameterDiff {
    pub(super) name: String,
    pub(super) unit: String,
    /// The two measured values. In pairs, the value in the first scene, and this value plus the
    /// measured change.
    pub(super) estimates: [Estimate; 2],
    /// The difference in standard errors, and the p-value of this difference: (a − b)/√(e_a² +
    /// e_b²), or in pairs (b − a)/e.
    pub(super) pull: (f64, f64),
    /// In pairs, the p-value of the hypothesis that nothing but this parameter has changed.
    pub(super) p_rest: Option<f64>,
}

/// The differences of the batches of two results at one plane.
pub(super) struct Pairs<'a> {
    slices: [&'a StoredSlices; 2],
    /// B_b − A_b of each batch.
    pub(super) differences: Residuals,
    seed: u64,
}

/// The reason why the batches of two results are not pairs, or `None` if they are.
pub(super) fn unpaired(a: &StoredResult, b: &StoredResult) -> Option<String> {
    let differs =
        |name: &str, [a, b]: [String; 2]| (a != b).then(|| format!("the {name} are {a} and {b}"));
    let of = |text: fn(&StoredResult) -> String| [text(a), text(b)];
    let run = |name: &str| [a, b].map(|result| result.index.scene_file["run"][name].to_string());
    let differing = [
        differs("methods", of(|result| result.index.method.clone())),
        differs("seeds", of(|result| result.index.seed.to_string())),
        differs("photons", of(|result| result.index.photons.to_string())),
        differs(
            "batches",
            of(|result| format!("{:?}", result.index.batches)),
        ),
        differs("kinds of sampling", run("sampling")),
        differs("kinds of emission", run("emission")),
    ];
    let missing = [a, b].into_iter().filter(|result| !result.has_batches());
    let missing = missing.map(|result| {
        let folder = result.folder().display();
        format!("{folder} has no batches (run it with --save batches)")
    });
    differing.into_iter().flatten().chain(missing).next()
}

impl<'a> Pairs<'a> {
    /// Reads the batches of both results at a plane.
    pub(super) fn read(
        results: [&StoredResult; 2],
        plane: &str,
        slices: [&'a StoredSlices; 2],
    ) -> Result<Self, Failure> {
        let grid = slices[0].grid;
        let [a, b] = results.map(|result| result.batches(plane, &grid));
        let (a, b) = (a?, b?);
        let [of_a, of_b] = [&a, &b].map(|of| of.slices.iter().map(|one| one.view()));
        Ok(Self {
            differences: Residuals::of_pairs(grid, of_a, of_b),
            slices,
            seed: results[0].index.seed,
        })
    }

    /// States that too few batches differ to give an error, if that is so.
    pub(super) fn few(&self) -> Option<String> {
        let (count, all) = (self.differences.differing(), self.differences.count());
        (1..MIN_DIFFERING).contains(&count).then(|| {
            format!("only {count} of {all} batches differ, too few to give errors of changes: more photons are needed")
        })
    }

    pub(super) fn test(&self) -> (TwoSamples, PairedNumbers) {
        let [a, b] = self.slices;
        let (grid, samples) = (&a.grid, [&a.sample, &b.sample]);
        let test = TwoSamples::paired(grid, samples, &self.differences, self.seed);
        let apart = TwoSamples::new(grid, samples[0], samples[1]);
        let predicted = a.predicted.as_ref().zip(b.predicted.as_ref());
        // The noise of a change that few photons meet is not known.
        let has_noise = self.differences.differing() >= MIN_DIFFERING;
        let is_exact = [a, b].iter().all(|slices| slices.is_closed_form);
        let predicted = predicted.filter(|_| has_noise && is_exact);
        let p_predicted =
            predicted.and_then(|(a, b)| self.differences.without(&(b - a)).p_value(self.seed));
        let numbers = PairedNumbers {
            unpaired_noise: apart.noise,
            p_predicted,
            few: self.few(),
        };
        (test, numbers)
    }

    /// Each parameter of the first result that the pairs determine: its value in the first scene,
    /// and this value plus the change that the differences measure.
    pub(super) fn parameters(&self, of_a: &[PredictedParameter]) -> Vec<ParameterDiff> {
        if self.few().is_some() {
            return Vec::new();
        }
        let variance = self.differences.variance();
        let batches = self.differences.count();
        let each = of_a.iter().filter_map(|parameter| {
            let found = score(&self.differences, &variance, parameter, 0.0)?;
            let known = Estimate {
                value: parameter.value,
                error: 0.0,
                batches,
            };
            let changed = Estimate {
                value: found.measured,
                error: found.error,
                batches,
            };
            let is_determined = parameter.value == 0.0 || found.error < parameter.value.abs();
            let pull = pull(changed, known).filter(|_| is_determined)?;
            let change = Complex::from(changed.value - known.value);
            let rest = &parameter.derivative.half * change;
            Some(ParameterDiff {
                name: found.name,
                unit: found.unit,
                estimates: [known, changed],
                pull,
                // The noise of a derivative by nets would count as a part of the rest.
                p_rest: (self.slices[0].is_closed_form)
                    .then(|| self.differences.without(&rest).p_value(self.seed))
                    .flatten(),
            })
        });
        each.collect()
    }
}

impl StoredResult {
    /// The parameters of the prediction of a plane, with their derivatives. The list is empty if
    /// the result has no predictions.
    pub(super) fn parameters(
        &self,
        plane: &str,
        slices: &StoredSlices,
    ) -> Result<Vec<PredictedParameter>, Failure> {
        let Some(mut file) = self.predictions()? else {
            return Ok(Vec::new());
        };
        let name = |array: &str| format!("{plane}/{array}");
        let names = file.texts(&name("parameters"))?;
        let units = file.texts(&name("units"))?;
        let values: ndarray::Array1<f64> = file.array(&name("values"), [names.len()])?;
        let [azimuths, rho, nu] = slices.grid.half_shape();
        let shape = [names.len(), azimuths, rho, nu];
        let derivatives: ndarray::Array4<_> = file.array(&name("derivatives"), shape)?;
        let each = names.into_iter().zip(units).zip(values);
        let each = each.zip(derivatives.outer_iter());
        Ok(each
            .map(|(((name, unit), value), derivative)| PredictedParameter {
                name,
                unit,
                value,
                derivative: Slices {
                    grid: slices.grid,
                    half: derivative.to_owned(),
                },
            })
            .collect())
    }
}
