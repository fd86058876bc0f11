//! The result of a fit: estimates with errors, what they are compared with, and what the spectra
//! cannot tell.

use crate::fit::data::FitData;
use crate::fit::model::{FitModel, scaled, size};
use crate::fit::search::{FitStarts, Minimum, minima};
use etendue_compare::{
    NormalEquations, Residuals, Verdict, chi_squared_above, fisher_information, least_eigenvector,
    solved,
};
use etendue_field::tidy;
use etendue_store::Failure;
use ndarray::{Array2, Axis};
use serde::Serialize;

/// A free field and its estimate.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FittedField {
    /// Path of the field.
    pub field: String,
    /// The value in the scene.
    pub start: f64,
    /// The estimate.
    pub value: f64,
    /// The standard error of the estimate; `None` if the spectra do not tell the field from others.
    pub error: Option<f64>,
    /// The error if all other fields were known.
    pub error_alone: Option<f64>,
    /// The Cramér–Rao bound of the error, from `fisher_information`.
    pub bound: Option<f64>,
}

/// Fields that change the spectra in nearly the same way.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Degeneracy {
    /// The relative changes of the fields that together change the spectra least; the largest is 1.
    pub changes: Vec<(String, f64)>,
    /// The information about this combination, as a share of that about single fields.
    pub information: f64,
    /// The combination in words.
    pub words: String,
}

/// A minimum of χ².
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FitMinimum {
    /// The values of the fields.
    pub values: Vec<f64>,
    /// Σ |S − F|²/σ².
    pub chi2: f64,
    /// Probability of a disagreement at least this large if the model is right.
    pub p_value: Option<f64>,
}

/// The result of a fit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fitted {
    /// The free fields.
    pub fields: Vec<FittedField>,
    /// The correlations of the estimates, [n, n].
    pub correlations: Vec<Vec<f64>>,
    /// The Fisher information of the slices about the fields, [n, n], for normal noise with the
    /// covariance that the batches tell.
    pub fisher_information: Option<Vec<Vec<f64>>>,
    /// Probability of a disagreement at least this large if the model is right.
    pub p_value: Option<f64>,
    /// The level of the test.
    pub level: f64,
    /// Pass if the model agrees, fail if it does not; undecided if the fields are not determined.
    pub verdict: Verdict,
    /// Why the fit is undecided.
    pub undecided: Option<String>,
    /// The combination of fields that is told worst, if it is told much worse than single fields.
    pub degeneracy: Option<Degeneracy>,
    /// The minima of χ² that were found, the lowest first.
    pub minima: Vec<FitMinimum>,
    /// The names of the planes.
    pub planes: Vec<String>,
    /// Number of photons, if it is known.
    pub photons: Option<u64>,
    /// The number of independent parts from which errors are computed; `None` if errors are
    /// computed from the stored standard deviations.
    pub groups: Option<usize>,
}

/// A combination is named if the information about it is at most this share of that about single
/// fields: its error is then ten times as large.
const NAMED: f64 = 0.01;
/// A combination with less information is not determined.
const UNDETERMINED: f64 = 1e-6;
/// Fields whose share of a combination is smaller are not named.
const MIN_SHARE: f64 = 0.2;

/// Fits the free fields of a model to its planes.
pub fn fit(
    model: &FitModel<'_>,
    data: &FitData,
    starts: &FitStarts,
    (level, seed): (f64, u64),
    advance: &dyn Fn(),
) -> Result<Fitted, Failure> {
    let found = minima(model, starts, advance)?;
    let judged = found.iter();
    let judged: Vec<JudgedMinimum> = judged
        .map(|of| JudgedMinimum::new(model, of, seed))
        .collect();
    let (best, lowest) = (&judged[0], &found[0]);
    // Relative changes have no meaning for a field that is 0 in the scene.
    let values = starts.values.iter().zip(&lowest.values);
    let values = values.map(|(start, value)| if *start == 0.0 { 0.0 } else { *value });
    let values: Vec<f64> = values.collect();
    let degeneracy = degeneracy_of(model.fields, &values, &lowest.information);
    let is_determined = is_determined(degeneracy.as_ref());
    let accepts = |judged: &JudgedMinimum| judged.p_value.is_none_or(|p| p >= level);
    let rivals = judged.iter().filter(|judged| accepts(judged)).count();
    let undecided = match &degeneracy {
        _ if !accepts(best) => None,
        Some(degeneracy) if !is_determined => Some(format!(
            "the spectra do not tell apart {}",
            degeneracy.words
        )),
        _ if rivals > 1 => Some(format!(
            "{rivals} distinct minima agree with the measurement"
        )),
        _ => without_value(model.fields, lowest)
            .or_else(|| (!lowest.has_converged).then(|| "the search has not converged".to_owned())),
    };
    let verdict = match (accepts(best), &undecided) {
        (false, _) => Verdict::Fail,
        (true, Some(_)) => Verdict::Undecided,
        (true, None) => Verdict::Pass,
    };
    let covariance = best.covariance.as_ref().filter(|_| is_determined);
    let minima = judged.iter().zip(&found);
    let minima = minima.map(|(judged, minimum)| FitMinimum {
        values: judged.values.clone(),
        chi2: minimum.chi2,
        p_value: judged.p_value,
    });
    let names = model.planes.iter().map(|data| data.plane.name.clone());
    Ok(Fitted {
        fields: best.fields(model.fields, &starts.values, covariance),
        correlations: covariance.map_or(Vec::new(), |of| rows(&scaled(of))),
        fisher_information: best.information.as_ref().map(rows),
        p_value: best.p_value,
        level,
        verdict,
        undecided,
        degeneracy,
        minima: minima.collect(),
        planes: names.collect(),
        photons: data.photons,
        groups: best.groups,
    })
}

/// A field may be any number if its error exceeds its value this many times.
const MAX_ERROR: f64 = 100.0;

/// Names a field whose error says that it may be any number.
fn without_value(fields: &[String], minimum: &Minimum) -> Option<String> {
    let errors = minimum.information.diag().mapv(|of| 1.0 / of.sqrt());
    let mut each = fields.iter().zip(&minimum.values).zip(&errors);
    let ((field, _), error) =
        each.find(|((_, value), error)| **error > MAX_ERROR * size(**value))?;
    Some(format!(
        "the spectra tell {field} only to about ± {error:.0e}"
    ))
}

fn rows(of: &Array2<f64>) -> Vec<Vec<f64>> {
    of.outer_iter().map(|row| row.to_vec()).collect()
}

/// A minimum with its errors and its test.
struct JudgedMinimum {
    values: Vec<f64>,
    /// The covariance of the values; `None` if they are not determined.
    covariance: Option<Array2<f64>>,
    /// The Fisher information.
    information: Option<Array2<f64>>,
    p_value: Option<f64>,
    groups: Option<usize>,
}

impl JudgedMinimum {
    fn new(model: &FitModel<'_>, minimum: &Minimum, seed: u64) -> Self {
        let mut judged = match model.planes.iter().any(|plane| plane.batches.is_empty()) {
            true => Self::of_variances(model, minimum),
            false => Self::of_batches(model, minimum, seed),
        };
        if let Some(covariance) = &mut judged.covariance {
            *covariance += &numerical(model, minimum);
            let column = minimum.left.view().insert_axis(Axis(1));
            *covariance += &column.dot(&column.t());
        }
        judged
    }

    /// The fields with their errors; `covariance` is `None` if they are not determined.
    fn fields(
        &self,
        names: &[String],
        starts: &[f64],
        covariance: Option<&Array2<f64>>,
    ) -> Vec<FittedField> {
        let root = |of: Option<&Array2<f64>>, i: usize| of.map(|of| of[[i, i]].sqrt());
        let alone = covariance.and_then(inverse);
        let bound = self.information.as_ref().filter(|_| covariance.is_some());
        let bound = bound.and_then(inverse);
        let each = names.iter().zip(starts).zip(&self.values).enumerate();
        each.map(|(i, ((field, start), value))| FittedField {
            field: field.clone(),
            start: *start,
            value: *value,
            error: root(covariance, i),
            error_alone: root(alone.as_ref(), i).map(|root| 1.0 / root),
            bound: root(bound.as_ref(), i),
        })
        .collect()
    }

    /// Errors from the spread of batches, and of the replicates of predictions, and a p-value from
    /// random signs of residuals from which the fitted steps are removed.
    fn of_batches(model: &FitModel<'_>, minimum: &Minimum, seed: u64) -> Self {
        let at = &minimum.at;
        let residuals = model.residuals(at);
        let groups = residuals[0].count();
        let equations = model.each(at, &residuals, 0..residuals.len());
        let products = residuals.iter().zip(model.planes);
        let products = products.map(|(of, data)| of.scaled_products(&data.variance));
        let products = products.reduce(|a, b| a + b).expect("a plane");
        let steps = equations.steps();
        let unexplained = residuals.into_iter().zip(&at.derivatives);
        let unexplained = unexplained.map(|(residuals, derivatives)| match &steps {
            Some(steps) => residuals.without_steps(derivatives, steps),
            None => residuals,
        });
        let unexplained: Vec<Residuals> = unexplained.collect();
        Self {
            values: minimum.values.clone(),
            covariance: steps.as_ref().map(spread),
            information: fisher_information(&equations, &products),
            p_value: Residuals::joint_p_value(&unexplained, seed),
            groups: Some(groups),
        }
    }

    /// Errors and p from stored variances, with independent noise at all frequencies and planes.
    fn of_variances(model: &FitModel<'_>, minimum: &Minimum) -> Self {
        // The real and the imaginary part have half of σ² each.
        let information = &minimum.information * 2.0;
        let cells = model.planes.iter().map(|data| {
            let independent = data.variance.indexed_iter();
            let grid = data.plane.grid;
            independent
                .filter(|((_, m, n), v)| grid.is_independent(*m, *n) && **v > 0.0)
                .count()
        });
        let dof = 2.0 * cells.sum::<usize>() as f64 - minimum.values.len() as f64;
        Self {
            values: minimum.values.clone(),
            covariance: inverse(&information),
            information: Some(information),
            p_value: (dof > 0.0).then(|| chi_squared_above(2.0 * minimum.chi2, dof)),
            groups: None,
        }
    }
}

/// The covariance of the mean of steps, [R, n].
pub(crate) fn spread(steps: &Array2<f64>) -> Array2<f64> {
    let count = steps.nrows() as f64;
    let apart = steps - &(steps.sum_axis(Axis(0)) / count);
    apart.t().dot(&apart) / (count * (count - 1.0))
}

/// The covariance of the steps that numerical errors of the predictions cause, at most: an error
/// ‖E‖ of the slices of a plane changes a step Re Σ w* E by at most ‖w‖ ‖E‖.
fn numerical(model: &FitModel<'_>, minimum: &Minimum) -> Array2<f64> {
    let count = minimum.values.len();
    let mut total: Array2<f64> = Array2::zeros((count, count));
    let each = model.planes.iter().zip(&minimum.at.predictions);
    for ((data, prediction), derivatives) in each.zip(&minimum.at.derivatives) {
        let is_exact = prediction.replicates.is_empty();
        let error = prediction.error().filter(|_| is_exact).unwrap_or(0.0);
        let size = error * prediction.slices.norm();
        let grid = prediction.slices.grid;
        let none = Residuals::of(grid, Vec::new());
        let weight = &data.variance * &data.variance;
        let squares = NormalEquations::new(&none, &weight, derivatives).information;
        total = total + squares * (size * size);
    }
    match inverse(&minimum.information) {
        Some(inverse) => inverse.dot(&total).dot(&inverse),
        None => total,
    }
}

/// The inverse of an information matrix.
pub(super) fn inverse(information: &Array2<f64>) -> Option<Array2<f64>> {
    solved(information, &Array2::eye(information.nrows()))
}

/// The combination of fields that is told worst, if it is told much worse than single fields.
pub(super) fn degeneracy_of(
    fields: &[String],
    values: &[f64],
    information: &Array2<f64>,
) -> Option<Degeneracy> {
    if fields.len() < 2 {
        return None;
    }
    let (least, shares) = least_eigenvector(&scaled(information));
    if least > NAMED {
        return None;
    }
    // Each change is relative to the value, or to 1 where the value is 0.
    let roots = information.diag().mapv(f64::sqrt);
    let largest = shares.iter().map(|share| share.abs()).fold(0.0, f64::max);
    let named = (0..fields.len()).filter(|i| shares[*i].abs() >= MIN_SHARE * largest);
    let changes = named.map(|i| (i, shares[i] / roots[i] / size(values[i])));
    let changes: Vec<(usize, f64)> = changes.collect();
    let most = changes.iter().map(|(_, by)| *by);
    let most = most.max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
    let changes = changes.into_iter().map(|(i, by)| (i, by / most));
    Some(Degeneracy {
        information: least.max(0.0),
        words: words(changes.clone().map(|(i, by)| (&*fields[i], values[i], by))),
        changes: changes.map(|(i, by)| (fields[i].clone(), by)).collect(),
    })
}

/// Whether fields are told from each other at all.
pub(super) fn is_determined(degeneracy: Option<&Degeneracy>) -> bool {
    degeneracy.is_none_or(|degeneracy| degeneracy.information > UNDETERMINED)
}

/// Names fields that change the spectra alike, with their values and relative changes: changes of
/// one per cent, or of 0.01 where the value is 0.
fn words<'a>(changes: impl Iterator<Item = (&'a str, f64, f64)> + Clone) -> String {
    let side = |rises: bool| {
        let side = changes.clone().filter(|(_, _, by)| (*by > 0.0) == rises);
        let words = side.map(|(field, value, by)| {
            let by = (by.abs() * 100.0).round() / 100.0;
            match value == 0.0 {
                true => format!("{field} by {}", tidy(0.01 * by)),
                false => format!("{field} by {} %", tidy(by)),
            }
        });
        words.collect::<Vec<_>>().join(" and ")
    };
    let [up, down] = [true, false].map(side);
    match down.is_empty() {
        true => format!("a rise of {up} from no change"),
        false => format!("a rise of {up} from a rise of {down}"),
    }
}
