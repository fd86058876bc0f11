//! Measures the derivative of the slices by a field of a scene, from pairs of runs with the same
//! random numbers.
//!
//! A central difference over a step h has a bias of h²/6 times the third derivative, and noise that
//! grows as h falls. The derivative is measured with three steps. The bias of each is measured by
//! the difference to the next, in pairs of batches too, and the largest step is taken at which the
//! bias is below the noise. Theory is compared over the same step, so bias does not enter.

mod table;

use crate::fit::{size, spread};
use crate::sweep::values::{Setting, Sweep, real_value};
use crate::sweep::{self, FinishedSweep, SweepPoints, SweepRequest};
use etendue_compare::{
    Class, Estimate, MIN_DIFFERING, NormalEquations, Residuals, Verdict, paired_changes, sidak,
};
use etendue_field::{Complex, Slices, VirtualPlane};
use etendue_pipeline::{Leader, Reporter, Work, load, stored_batches};
use etendue_predict::{Applicability, predict};
use etendue_scene::{Scene, dotted};
use etendue_spectrum::{Measurement, Uncertain, estimate};
use etendue_store::npz::Npz;
use etendue_store::{ArgumentStyle, Failure};
use ndarray::Array3;
use std::path::Path;

/// Theory is as accurate as this many times the photons of a run need, because pairs have less noise.
const ACCURACY: u64 = 16;

/// A field by which slices are differentiated, and the largest step of its differences.
#[derive(Clone, Debug, PartialEq)]
pub struct DerivedField {
    /// Path of the field.
    pub path: String,
    /// The largest step; `None` for 4 % of the value, or 0.04 if the value is 0.
    pub step: Option<f64>,
}

/// The largest step, as a share of the value.
const FIRST_STEP: f64 = 0.04;
/// The steps as shares of the largest. At each, the bias is a sixteenth of that before.
const STEPS: [f64; 3] = [1.0, 0.25, 0.0625];
/// The bias of a step as a share of its difference to the derivative with the next step, for the
/// first step, or with the step before, for the others: D(h) − D(h/4) = (1 − 1/16) h²/6 S‴.
const BIAS: [f64; 3] = [16.0 / 15.0, 1.0 / 15.0, 1.0 / 15.0];

/// The derivative of the slices at a plane, measured with one step.
#[derive(Clone, Debug)]
pub struct PlaneDerivative {
    /// Name of the plane.
    pub plane: String,
    /// Half of the difference between the two values of the field.
    pub step: f64,
    /// Whether this step is chosen among the steps of its plane.
    pub is_chosen: bool,
    /// ‖∂S/∂p‖/‖S‖, in one over the unit of the field.
    pub size: f64,
    /// ‖error‖/‖∂S/∂p‖ from the spread of pairs of batches; `None` if too few of them differ.
    pub noise: Option<f64>,
    /// ‖bias‖/‖∂S/∂p‖, measured; with one standard error of its square added.
    pub bias: Option<f64>,
    /// The measured derivative as a multiple of theory's, by least squares; `None` without theory.
    pub share: Option<Estimate>,
    /// The p-value of the hypothesis that theory's difference over the same step is true. `None` if
    /// predictions have numerical errors that replicates do not show.
    pub p_value: Option<f64>,
    /// The derivatives of both bandwidths and of the slope, with their errors from pairs of batches.
    pub numbers: [Option<Uncertain>; 3],
}

impl PlaneDerivative {
    /// Why the derivative is not known.
    fn open(&self) -> Option<&'static str> {
        match (self.noise, self.bias) {
            _ if self.size == 0.0 => None,
            (Some(noise), Some(bias)) if bias <= noise => None,
            (Some(_), Some(_)) => {
                Some("the bias of the smallest step is above the noise: state a smaller step")
            }
            _ => Some("too few batches differ to give errors: more photons are needed"),
        }
    }
}

/// A measured derivative.
#[derive(Debug)]
pub struct Derivative {
    /// Path of the field.
    pub field: String,
    /// Value of the field.
    pub value: f64,
    /// The chosen step of each plane.
    pub planes: Vec<PlaneDerivative>,
    /// Fail if theory disagrees at a plane, undecided if a derivative has no errors, or a bias above
    /// its noise.
    pub verdict: Verdict,
    /// The sweep over the values from which it is measured.
    pub sweep: FinishedSweep,
}

/// The name of the table, and of the arrays of a plane.
const TABLE: &str = "derivative.csv";
const ARRAYS: &str = "derivative.npz";

impl DerivedField {
    /// Parses FIELD or FIELD=STEP.
    pub fn parse(text: &str) -> Result<Self, String> {
        let (path, step) = match text.split_once('=') {
            None => (text, None),
            // No step is not a number.
            Some((path, step)) => (path, Some(step.trim().parse().unwrap_or(f64::NAN))),
        };
        let of_step = |allowed| format!("must be FIELD or FIELD=STEP, with {allowed}");
        Self::new(path, step).map_err(of_step)
    }

    /// The field at a path. Fails with the allowed steps if `step` is not one.
    pub fn new(path: &str, step: Option<f64>) -> Result<Self, &'static str> {
        if step.is_some_and(|step| !(step.is_finite() && step > 0.0)) {
            return Err("a step above 0");
        }
        Ok(Self {
            path: dotted(path.trim()),
            step,
        })
    }

    /// Turns a request into that of a sweep over the values from which the derivative is measured.
    /// Returns the value of the field in the scene.
    pub fn sweep(&self, request: &mut SweepRequest) -> Result<f64, Failure> {
        let arguments = request.scene.arguments;
        let (source, sweeps) = request.settings();
        let argument = match arguments {
            ArgumentStyle::Command => arguments.with("derivative", &self.path),
            ArgumentStyle::Python => arguments.with("field", &self.path),
        };
        if let Some(Sweep { path, .. }) = sweeps.first() {
            return Err(Failure::bad_input(format!(
                "{} has several values; allowed beside {argument}: one value",
                arguments.with("set", path),
            )));
        }
        let value = real_value(&load::scene(&source, |_| ())?, &self.path, argument)?;
        let step = self.step.unwrap_or(FIRST_STEP * size(value));
        for end in [value - step, value + step] {
            let point = vec![(self.path.clone(), end)];
            sweep::scene_at(&source, &point, |_| ()).map_err(|failure| Failure {
                message: format!(
                    "{}: a value at a step of the derivative by {} is not allowed; {} states a smaller step",
                    failure.message,
                    self.path,
                    match arguments {
                        ArgumentStyle::Command => "--derivative FIELD=STEP",
                        ArgumentStyle::Python => "step=",
                    }
                ),
                ..failure
            })?;
        }
        let is_own = |of: &Setting| matches!(of, Setting::Value(path, _) if *path == self.path);
        request.set.retain(|setting| !is_own(setting));
        // The steps up to the largest, from low values to high.
        let below = STEPS.iter().map(|share| -share);
        let moves = below.chain(STEPS.iter().rev().copied());
        let values = moves.map(|share| value + share * step).collect();
        request.set.push(Setting::Sweep(Sweep {
            path: self.path.clone(),
            values,
        }));
        request.common_seed = true;
        Ok(value)
    }
}

/// Measures a derivative; the runs, the table and the arrays are stored in `folder`.
pub fn derivative(
    field: &DerivedField,
    value: f64,
    (request, points, folder): (&SweepRequest, &SweepPoints, &Path),
    workers: Option<&Leader<'_>>,
    reporter: &dyn Reporter,
) -> Result<Derivative, Failure> {
    let planes = &points.base.planes;
    for (plane, other) in points
        .scenes
        .iter()
        .flat_map(|at| planes.iter().zip(&at.planes))
    {
        if plane.grid != other.grid {
            return Err(Failure::bad_input(format!(
                "the frequencies of plane {} depend on {}, so slices have no derivative by it",
                plane.name, field.path
            )));
        }
    }
    let arrays = planes
        .iter()
        .map(|plane| format!("{}/{ARRAYS}", plane.name));
    let names: Vec<String> = arrays.chain([TABLE.to_owned()]).collect();
    let sweep = sweep::begin(request, points, folder, &names, workers, reporter)?;
    let stage = reporter.begin(Work::Stage("measuring derivatives"));
    // The points before and after the value, for each step.
    let ends = [0, 1, 2].map(|rung| [rung, 2 * STEPS.len() - 1 - rung]);
    let read = |i: usize| stored_batches(&folder.join(&sweep.found[i].folder), &points.scenes[i]);
    let pair = |[a, b]: &[usize; 2]| Ok([read(*a)?, read(*b)?]);
    let measured: Vec<_> = ends.iter().map(pair).collect::<Result<_, Failure>>()?;
    let of_point = |i: usize| sweep.found[i].point[0].1;
    let steps = ends.map(|[a, b]| 0.5 * (of_point(b) - of_point(a)));
    let mut files = Vec::new();
    let mut all = Vec::new();
    for (i, plane) in planes.iter().enumerate() {
        let ladder = Ladder::new(plane, &measured, i, steps)?;
        let theory = |rung: usize| {
            let scenes = ends[rung].map(|end| &points.scenes[end]);
            theory(scenes, i, steps[rung])
        };
        let (rungs, bytes) = ladder.judged(points.base.run.seed, &theory)?;
        files.push((format!("{}/{ARRAYS}", plane.name), bytes));
        all.extend(rungs);
    }
    files.push((TABLE.to_owned(), PlaneDerivative::csv(&field.path, &all)?));
    drop(stage);
    let chosen = all.into_iter().filter(|plane| plane.is_chosen);
    let chosen: Vec<PlaneDerivative> = chosen.collect();
    Ok(Derivative {
        field: field.path.clone(),
        value,
        verdict: verdict(&chosen, points.base.run.alpha),
        planes: chosen,
        sweep: sweep.finish(files, reporter)?,
    })
}

/// The derivative at one plane for each step.
struct Ladder<'a> {
    plane: &'a VirtualPlane,
    steps: [f64; 3],
    /// The spectrum at the lower value of the largest step.
    lowest: Array3<Complex>,
    /// ‖S‖ in the middle of the smallest step.
    norm: f64,
    derivatives: Vec<Residuals>,
    /// The changes of these numbers over two steps.
    changes: Vec<[Option<Uncertain>; 3]>,
}

/// Theory's difference over a step, with its replicates.
struct TheoryDifference {
    slices: Slices,
    replicates: Vec<Slices>,
    /// Whether replicates show all errors of the slices.
    has_known_errors: bool,
}

impl<'a> Ladder<'a> {
    fn new(
        plane: &'a VirtualPlane,
        measured: &[[Measurement; 2]],
        i: usize,
        steps: [f64; 3],
    ) -> Result<Self, Failure> {
        let mean = |of: &Measurement| {
            let slices = estimate::slices(of, i).map_err(Failure::cannot_run)?;
            Ok::<_, Failure>(slices.mean)
        };
        let [first, .., [below, above]] = measured else {
            unreachable!("there are several steps")
        };
        let (mut middle, above) = (mean(below)?, mean(above)?);
        middle.half += &above.half;
        let derivatives = measured.iter().zip(steps).map(|(pair, step)| {
            let [a, b] = pair
                .each_ref()
                .map(|end| end.at_plane(i).map(|batch| batch.slices.half.view()));
            Residuals::of_pairs(plane.grid, a, b).scaled(1.0 / (2.0 * step))
        });
        let changes = measured.iter().map(|[a, b]| paired_changes([a, b], i));
        Ok(Self {
            plane,
            steps,
            changes: changes
                .collect::<Result<_, _>>()
                .map_err(Failure::cannot_run)?,
            lowest: mean(&first[0])?.half,
            norm: 0.5 * middle.norm(),
            derivatives: derivatives.collect(),
        })
    }

    /// Each step, and the arrays of the chosen step.
    fn judged(
        &self,
        seed: u64,
        theory: &dyn Fn(usize) -> Option<TheoryDifference>,
    ) -> Result<(Vec<PlaneDerivative>, Vec<u8>), Failure> {
        let theories: Vec<_> = (0..STEPS.len()).map(theory).collect();
        let each = theories.iter().enumerate();
        let mut rungs: Vec<_> = each
            .map(|(k, theory)| self.rung(k, theory.as_ref(), seed))
            .collect();
        // If too few batches differ, smaller steps do not help.
        let is_settled = |rung: &PlaneDerivative| rung.noise.is_none() || rung.open().is_none();
        let last = STEPS.len() - 1;
        let chosen = rungs.iter().position(is_settled).unwrap_or(last);
        rungs[chosen].is_chosen = true;
        let grid = &self.plane.grid;
        let of = &self.derivatives[chosen];
        let npz = Npz::default()
            .add_half_axes(grid)?
            .add("derivative", &of.mean())?
            .add("sigma", &of.variance().mapv(f64::sqrt))?
            .add("step", &ndarray::arr0(self.steps[chosen]))?;
        let bytes = match &theories[chosen] {
            Some(theory) => npz.add("predicted", &theory.slices.half)?.bytes()?,
            None => npz.bytes()?,
        };
        Ok((rungs, bytes))
    }

    fn rung(&self, k: usize, theory: Option<&TheoryDifference>, seed: u64) -> PlaneDerivative {
        let of = &self.derivatives[k];
        let has_errors = of.differing() >= MIN_DIFFERING;
        let variance = of.variance();
        let (grid, half) = (self.plane.grid, of.mean());
        let length = Slices { grid, half }.norm();
        let beside = &self.derivatives[if k == 0 { 1 } else { k - 1 }];
        let apart = of.minus(beside);
        let (square, error) = apart.squared();
        let bias = BIAS[k] * (square.max(0.0) + error).sqrt();
        let mut share = None;
        let mut p_value = None;
        if let Some(theory) = theory.filter(|_| has_errors) {
            let batches = of.slices();
            let batches: Vec<&Slices> = batches.iter().collect();
            let residuals =
                Residuals::between_samples(&batches, &theory.slices, &theory.replicates);
            share = theory.share(&residuals);
            let measured = &self.lowest / Complex::from(2.0 * self.steps[k]);
            let p = residuals.within_error_of(&measured).p_value(seed);
            p_value = p.filter(|_| theory.has_known_errors);
        }
        PlaneDerivative {
            plane: self.plane.name.clone(),
            step: self.steps[k],
            is_chosen: false,
            size: length / self.norm,
            noise: has_errors.then(|| variance.sum().sqrt() / length),
            bias: has_errors.then(|| bias / length),
            share,
            p_value,
            numbers: self.changes[k].map(|change| {
                let [value, error] = change
                    .map(|of| [of.value, of.error])?
                    .map(|x| 0.5 * x / self.steps[k]);
                Some(Uncertain { value, error })
            }),
        }
    }
}

impl TheoryDifference {
    /// The multiple of the slices with which residuals would vanish: 1 + ⟨T, r⟩/⟨T, T⟩ over the
    /// independent frequencies. ⟨T, T⟩ would be too large by the noise of T, which the spread of the
    /// replicates tells and which is taken off. `None` if T is mostly noise.
    fn share(&self, residuals: &Residuals) -> Option<Estimate> {
        let one = Array3::from_elem(self.slices.half.raw_dim(), 1.0);
        let product =
            |of: &Array3<Complex>| NormalEquations::new(residuals, &one, std::slice::from_ref(of));
        let noise = match self.replicates.len() {
            0 => 0.0,
            _ => {
                let each = self.replicates.iter().map(|one| one.half.clone());
                let spread = Residuals::of(self.slices.grid, each.collect()).variance();
                product(&spread.mapv(|square| Complex::from(square.sqrt()))).information[[0, 0]]
            }
        };
        let NormalEquations {
            information,
            scores,
        } = product(&self.slices.half);
        let square = information[[0, 0]] - noise;
        (square > noise).then(|| Estimate {
            value: 1.0 + (scores.sum() / scores.len() as f64 + noise) / square,
            error: spread(&scores)[[0, 0]].sqrt() / square,
            batches: scores.len(),
        })
    }
}

/// Theory's central difference at plane `i` between two scenes; `None` if theory has no prediction
/// there, or if the windows differ.
fn theory(scenes: [&Scene; 2], i: usize, step: f64) -> Option<TheoryDifference> {
    if scenes[0].planes[i].window != scenes[1].planes[i].window {
        return None;
    }
    let end = |scene: &Scene| {
        let mut scene = scene.clone();
        scene.run.photons = ACCURACY.saturating_mul(scene.run.photons);
        let plane = &scene.planes[i];
        let theory = Applicability::new(&scene, plane);
        (theory.class() != Class::Reference).then(|| predict(&scene, plane, &theory))
    };
    let [a, b] = scenes.map(end);
    let (a, b) = (a?, b?);
    let scale = Complex::from(0.5 / step);
    let between = |a: &Slices, b: &Slices| Slices {
        grid: b.grid,
        half: (&b.half - &a.half) * scale,
    };
    let counts = [&a, &b].map(|end| end.replicates.len());
    let pairs = a.replicates.iter().zip(&b.replicates);
    Some(TheoryDifference {
        slices: between(&a.slices, &b.slices),
        replicates: pairs.map(|(a, b)| between(a, b)).collect(),
        has_known_errors: counts[0] == counts[1]
            && (counts[0] > 0 || a.error().or(b.error()).is_none()),
    })
}

fn verdict(planes: &[PlaneDerivative], alpha: f64) -> Verdict {
    let p_values = || planes.iter().filter_map(|plane| plane.p_value);
    let level = sidak(alpha, p_values().count());
    if p_values().any(|p| p < level) {
        Verdict::Fail
    } else if planes.iter().any(|plane| plane.open().is_some()) {
        Verdict::Undecided
    } else {
        Verdict::Pass
    }
}
