//! Returns the output of `etendue diff --json`.

use super::difference::Diff;
use super::pairs::ParameterDiff;
use super::planes::PlaneDiff;
use super::stored::StoredResult;
use etendue_compare::Estimate;
use etendue_store::fields::FieldChange;
use serde_json::{Value, json};

/// The numbers of [`text`](super::text). The verdict *pass* means that the results are the
/// same, and *fail* that they differ.
#[must_use]
pub fn json(diff: &Diff) -> Value {
    let level = diff.level();
    let fields = diff.scene.iter();
    let fields =
        fields.map(|FieldChange { field, values }| json!({"field": field, "values": values}));
    let planes = diff.planes.iter().map(|plane| of_plane(plane, level));
    json!({
        "verdict": diff.verdict(),
        "alpha": diff.alpha,
        "level": level,
        "pairs": diff.unpaired.is_none(),
        "not_pairs": diff.unpaired,
        "results": diff.results.each_ref().map(of_result),
        "scene": fields.collect::<Vec<_>>(),
        "planes": planes.collect::<Vec<_>>(),
    })
}

fn of_result(result: &StoredResult) -> Value {
    let index = &result.index;
    json!({
        "folder": result.folder(),
        "scene": index.scene,
        "photons": index.photons,
        "batches": index.batches.len(),
        "method": index.method,
        "seed": index.seed,
        "version": index.version,
    })
}

fn of_plane(plane: &PlaneDiff, level: f64) -> Value {
    let mut found = json!({
        "name": plane.name,
        "verdict": plane.verdict(level),
        "undecided": plane.undecided(level),
    });
    if let Some(compared) = plane.compared() {
        let test = &compared.test;
        let parameters = compared.parameters.iter().map(of_parameter);
        found["chi2_per_dof"] = json!(test.chi2_per_dof);
        found["p_value"] = json!(test.p_value);
        found["difference"] = json!(test.difference);
        found["noise"] = json!(test.noise);
        found["slopes"] = json!(compared.slopes.map(|slope| slope.map(of_estimate)));
        let predictions = compared.prediction.as_ref().map(|of| of.difference);
        found["predictions_apart"] = json!(predictions);
        if let Some(pairs) = &compared.pairs {
            found["unpaired_noise"] = json!(pairs.unpaired_noise);
            found["p_value_of_predicted_difference"] = json!(pairs.p_predicted);
        }
        found["parameters"] = parameters.collect();
    }
    found
}

fn of_parameter(parameter: &ParameterDiff) -> Value {
    let (pull, p_value) = parameter.pull;
    let mut of = json!({
        "name": parameter.name,
        "unit": parameter.unit,
        "measured": parameter.estimates.map(of_estimate),
        "sigma_apart": pull,
        "p_value": p_value,
    });
    if let Some(p_rest) = parameter.p_rest {
        of["p_value_of_rest"] = json!(p_rest);
    }
    of
}

fn of_estimate(estimate: Estimate) -> Value {
    json!({"value": estimate.value, "error": estimate.error})
}
