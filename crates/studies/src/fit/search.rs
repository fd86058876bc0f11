//! The search for minima of χ²: from several starts, and from low frequencies to all.

use crate::fit::model::{FitModel, Linearised, first_steps, steps};
use etendue_compare::solved;
use etendue_store::{Failure, FailureKind};
use ndarray::{Array1, Array2, Axis};

/// The shares of the largest frequency of the levels of a search. At low frequencies, χ² has few
/// minima, and these are wide.
const LEVELS: [f64; 4] = [0.125, 0.25, 0.5, 1.0];
/// The largest number of minima that each level hands on to the next.
const KEPT: [usize; 4] = [4, 3, 2, 2];
/// The largest number of steps at a level.
const MAX_STEPS: usize = 40;
/// A search ends when χ² is expected to fall by less, if noise at all frequencies is independent.
/// The values are then within a thirtieth of their errors.
const SMALL_FALL: f64 = 1e-3;
/// A search has converged if it ends where χ² is expected to fall by less: the values are then within
/// one of their errors, to which the expected step is added.
const MAX_FALL: f64 = 1.0;
/// Minima are the same if χ² between them rises by less.
const SAME: f64 = 1.0;
/// The damping of the first step, as a share of the information (Marquardt 1963), its factor after
/// a step, and its largest value.
const DAMPING: f64 = 1e-3;
const DAMPING_FACTOR: f64 = 10.0;
const MAX_DAMPING: f64 = 1e6;

/// The ranges from which a search starts.
#[derive(Clone, Debug)]
pub struct FitStarts {
    /// The values of the free fields in the scene, which are the first start.
    pub values: Vec<f64>,
    /// The range of each field for further starts.
    pub ranges: Vec<[f64; 2]>,
    /// Number of starts.
    pub count: usize,
}

/// A minimum of χ².
pub(super) struct Minimum {
    pub(super) values: Vec<f64>,
    pub(super) chi2: f64,
    pub(super) information: Array2<f64>,
    /// The predictions and their derivatives at the minimum.
    pub(super) at: Linearised,
    /// The steps of the finite differences of a next linearisation.
    pub(super) steps: Vec<f64>,
    /// The step from the values to where the minimum is expected: χ² did not fall along it, because
    /// of the noise of predictions.
    pub(super) left: Array1<f64>,
    pub(super) has_converged: bool,
}

impl FitStarts {
    /// The first level of the search. A single start is taken as near.
    fn first_level(&self) -> usize {
        if self.count == 1 { LEVELS.len() - 1 } else { 0 }
    }

    /// The largest number of descents of the search.
    pub(super) fn descents(&self) -> usize {
        let later = &KEPT[self.first_level()..KEPT.len() - 1];
        self.count + later.iter().sum::<usize>()
    }

    /// The starting points: the values of the scene, and points of a Kronecker sequence that fill
    /// the ranges evenly.
    fn points(&self) -> Vec<Vec<f64>> {
        let n = self.values.len();
        // The root of x^(n + 1) = x + 1, whose inverse powers are the steps of the sequence
        // (Roberts 2018).
        let root = (0..64).fold(2.0_f64, |x, _| libm::pow(1.0 + x, 1.0 / (n + 1) as f64));
        let point = |k: usize| {
            let share = |i: usize| {
                let turn = 0.5 + k as f64 * libm::pow(root, -((i + 1) as f64));
                turn - turn.floor()
            };
            let ranges = self.ranges.iter().enumerate();
            ranges
                .map(|(i, [from, to])| from + share(i) * (to - from))
                .collect()
        };
        std::iter::once(self.values.clone())
            .chain((1..self.count).map(point))
            .collect()
    }
}

/// The minima of χ² that a search from several starts finds, the lowest first.
///
/// Each start descends at the lowest frequencies. The best minima are starts of the next level.
pub(super) fn minima(
    model: &FitModel<'_>,
    starts: &FitStarts,
    advance: &dyn Fn(),
) -> Result<Vec<Minimum>, Failure> {
    let begin = |values: Vec<f64>| (first_steps(&values), values);
    let mut begins: Vec<_> = starts.points().into_iter().map(begin).collect();
    let mut minima = Vec::new();
    for (share, kept) in LEVELS.into_iter().zip(KEPT).skip(starts.first_level()) {
        let mut failure = None;
        let mut found: Vec<Minimum> = Vec::new();
        for (steps, values) in begins {
            match descended(model, values, steps, share) {
                Ok(minimum) => found.push(minimum),
                // A start may be outside of what a scene allows.
                Err(other) if other.kind == FailureKind::BadInput => {
                    failure = failure.or(Some(other));
                }
                Err(other) => return Err(other),
            }
            advance();
        }
        found.sort_by(|a, b| a.chi2.total_cmp(&b.chi2));
        found = distinct(found);
        found.truncate(kept);
        if let (true, Some(failure)) = (found.is_empty(), failure) {
            return Err(failure);
        }
        let next = found.iter();
        begins = next
            .map(|at| (at.steps.clone(), at.values.clone()))
            .collect();
        minima = found;
    }
    Ok(minima)
}

/// The minima without those that repeat a lower one.
fn distinct(all: Vec<Minimum>) -> Vec<Minimum> {
    let mut distinct: Vec<Minimum> = Vec::new();
    for minimum in all {
        let repeats = |lower: &Minimum| {
            let apart = &Array1::from(minimum.values.clone()) - &Array1::from(lower.values.clone());
            apart.dot(&lower.information.dot(&apart)) < SAME.max(SMALL_FALL * lower.chi2)
        };
        if !distinct.iter().any(repeats) {
            distinct.push(minimum);
        }
    }
    distinct
}

/// Descends from a point to a minimum of χ² by damped Gauss–Newton steps (Marquardt 1963).
fn descended(
    model: &FitModel<'_>,
    mut values: Vec<f64>,
    mut differences: Vec<f64>,
    share: f64,
) -> Result<Minimum, Failure> {
    let mut damping = DAMPING;
    let here = model.predict(&values, share)?;
    let mut chi2 = model.chi2(&here);
    let mut at = model.linearised(&values, here, &differences, share)?;
    let mut rounds = 0;
    loop {
        let equations = model.equations(&at);
        check(model, &equations.information)?;
        let information = equations.information;
        differences = steps(&values, &information);
        let scores = equations.scores.t().to_owned();
        let next = loop {
            let mut damped = information.clone();
            damped.diag_mut().mapv_inplace(|of| of * (1.0 + damping));
            let step = step_of(&damped, &scores);
            let fall = step
                .as_ref()
                .map_or(0.0, |step| step.dot(&information.dot(step)));
            if fall < SMALL_FALL || rounds == MAX_STEPS {
                break None;
            }
            let moved: Vec<f64> = values
                .iter()
                .zip(step.iter().flatten())
                .map(|(v, s)| v + s)
                .collect();
            match model.predict(&moved, share) {
                Ok(there) => {
                    let lower = model.chi2(&there);
                    if lower < chi2 {
                        chi2 = lower;
                        damping /= DAMPING_FACTOR;
                        break Some((moved, there));
                    }
                }
                Err(failure) if failure.kind != FailureKind::BadInput => return Err(failure),
                Err(_) => {}
            }
            if damping > MAX_DAMPING {
                break None;
            }
            damping *= DAMPING_FACTOR;
        };
        let Some((moved, there)) = next else {
            let left = step_of(&information, &scores).unwrap_or(Array1::zeros(values.len()));
            let is_near = left.dot(&information.dot(&left)) < MAX_FALL;
            return Ok(Minimum {
                values,
                chi2,
                information,
                at,
                steps: differences,
                left,
                has_converged: is_near && rounds < MAX_STEPS,
            });
        };
        values = moved;
        at = model.linearised(&values, there, &differences, share)?;
        rounds += 1;
    }
}

/// The step that solves normal equations; `None` if they are singular.
fn step_of(information: &Array2<f64>, scores: &Array2<f64>) -> Option<Array1<f64>> {
    Some(solved(information, scores)?.index_axis_move(Axis(1), 0))
}

/// Fails if the spectrum does not depend on a field.
fn check(model: &FitModel<'_>, information: &Array2<f64>) -> Result<(), Failure> {
    let unknown = information
        .diag()
        .iter()
        .position(|of| of.is_nan() || *of <= 0.0);
    match unknown {
        None => Ok(()),
        Some(i) => Err(Failure::bad_input(format!(
            "at the start, the predicted spectra do not depend on {}",
            model.fields[i]
        ))),
    }
}
