//! Formats the output of `etendue diff`.

use super::difference::{Diff, has_other_inputs, is_of_run};
use super::planes::{Compared, PlaneDiff, PlaneDifference, ROUNDING, SLICES};
use super::stored::{ResultIndex, StoredResult};
use crate::table::{aligned, below_header, number, percent, undecided, with_unit};
use etendue_compare::{Estimate, Verdict};
use etendue_field::{grouped, percent as percent_of, tidy, uncertain};
use etendue_store::fields::FieldChange;

/// The maximum number of differing fields that are listed.
const MOST_FIELDS: usize = 8;

/// The output of `etendue diff`.
#[must_use]
pub fn text(diff: &Diff) -> String {
    let mut lines = vec![header('A', &diff.results[0]), header('B', &diff.results[1])];
    lines.extend(scene(diff));
    lines.push(match &diff.unpaired {
        Some(why) => format!("pairs: no, because {why}"),
        None => "pairs: batches of both results have the same random numbers, so most of their noise cancels. \
            They show what changed, not whether theory is right"
            .to_owned(),
    });
    lines.push(String::new());
    lines.extend(aligned(planes(diff)));
    let parameters = parameters(diff);
    if parameters.len() > 1 {
        lines.push(String::new());
        lines.extend(aligned(parameters));
    }
    lines.push(String::new());
    lines.push(format!("verdict: {}", verdict(diff)));
    lines.join("\n")
}

fn header(letter: char, result: &StoredResult) -> String {
    let ResultIndex {
        scene,
        version,
        seed,
        method,
        photons,
        batches,
        ..
    } = &result.index;
    format!(
        "{letter}: {}: {scene}, {} photons in {batches} batches, method {method}, seed {seed}, version {version}",
        result.folder().display(),
        grouped(*photons),
        batches = batches.len()
    )
}

/// Describes the fields in which the scenes differ.
fn scene(diff: &Diff) -> Vec<String> {
    let [a, b] = &diff.results;
    let changes = &diff.scene;
    if has_other_inputs(a, b, changes) {
        return vec!["scene: the same fields, but another mesh or picture".to_owned()];
    }
    if changes.is_empty() {
        return vec!["scene: the same".to_owned()];
    }
    let head = if changes.iter().all(is_of_run) {
        "scene: the same scene, but with other settings of the run"
    } else {
        "scene: another"
    };
    let shown = changes.iter().take(MOST_FIELDS);
    let mut lines = vec![head.to_owned()];
    let shown =
        shown.map(|FieldChange { field, values }| format!("  {field}: {}", values.join(" and ")));
    lines.extend(shown);
    let more = changes.len().saturating_sub(MOST_FIELDS);
    lines.extend((more > 0).then(|| format!("  and {more} more")));
    lines
}

fn planes(diff: &Diff) -> Vec<Vec<String>> {
    let special = match diff.unpaired {
        None => ["noise without pairs", "predictions", "p of predictions"].as_slice(),
        Some(_) => &["shear slope A [m]", "B", "σ apart", "predictions"],
    };
    let common = ["plane", "χ²/dof", "p", "difference", "noise alone"];
    let header = [&common, special, &["verdict"]].concat();
    let level = diff.level();
    let rows = diff.planes.iter().map(|plane| {
        let mut row = vec![plane.name.clone()];
        row.extend(match plane.compared() {
            Some(compared) => cells(compared),
            None => vec!["–".to_owned(); header.len() - 2],
        });
        row.push(word(plane.verdict(level)).to_owned());
        row
    });
    below_header(&header, rows)
}

fn cells(plane: &Compared) -> Vec<String> {
    let test = &plane.test;
    let mut cells = vec![
        number(test.chi2_per_dof, 3),
        number(test.p_value, 5),
        percent(Some(test.difference)),
        percent(Some(test.noise)),
    ];
    let predictions = match &plane.prediction {
        None => "–".to_owned(),
        Some(of) if of.difference <= ROUNDING => "the same".to_owned(),
        Some(of) => format!("{} apart", percent_of(of.difference, 3)),
    };
    if let Some(pairs) = &plane.pairs {
        cells.push(percent(Some(pairs.unpaired_noise)));
        cells.push(predictions);
        cells.push(number(pairs.p_predicted, 5));
        return cells;
    }
    let slope = |slope: Option<Estimate>| slope.map_or("–".to_owned(), shown);
    let [a, b] = plane.slopes;
    let pull = a.zip(b).and_then(|(a, b)| etendue_compare::pull(a, b));
    cells.extend([slope(a), slope(b), number(pull.map(|(pull, _)| pull), 2)]);
    cells.push(predictions);
    cells
}

fn shown(estimate: Estimate) -> String {
    if estimate.error > 0.0 {
        uncertain(estimate.value, estimate.error)
    } else {
        tidy(estimate.value)
    }
}

fn parameters(diff: &Diff) -> Vec<Vec<String>> {
    let header = match diff.unpaired {
        None => [
            "plane",
            "parameter",
            "A",
            "B − A",
            "σ apart",
            "p",
            "p of the rest",
        ]
        .as_slice(),
        Some(_) => &["plane", "parameter", "A", "B", "σ apart", "p"],
    };
    let rows = diff.planes.iter().flat_map(|plane| {
        let found = plane.compared().map(|compared| &compared.parameters);
        found.into_iter().flatten().map(|parameter| {
            let [a, mut b] = parameter.estimates;
            if diff.unpaired.is_none() {
                b.value -= a.value;
            }
            let [a, b] = [a, b].map(shown);
            let (pull, p) = parameter.pull;
            let parameter_rest = parameter.p_rest;
            let parameter = with_unit(&parameter.name, &parameter.unit);
            let [pull, p] = [number(Some(pull), 2), number(Some(p), 5)];
            let mut row = vec![plane.name.clone(), parameter, a, b, pull, p];
            row.extend(diff.unpaired.is_none().then(|| number(parameter_rest, 5)));
            row
        })
    });
    below_header(header, rows)
}

fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Pass => "same",
        Verdict::Fail => "different",
        Verdict::Undecided => "undecided",
    }
}

/// A sentence with the verdict and its reasons.
fn verdict(diff: &Diff) -> String {
    let level = diff.level();
    let alpha = format!("{} %", tidy(100.0 * diff.alpha));
    match diff.verdict() {
        Verdict::Pass if diff.planes.iter().all(is_identical) => {
            let same_bytes = diff.planes.iter().all(|plane| has_same_bytes(diff, plane));
            let how = if same_bytes {
                "byte for byte"
            } else {
                "except for rounding"
            };
            format!("same: both have the same seed and photons, and the same numbers {how}")
        }
        Verdict::Pass => {
            let [slices, parameters] = diff.tests();
            format!(
                "same: nothing differs beyond noise (α = {alpha} over {slices} planes and {parameters} parameters: p ≥ {level:.1e} at each)"
            )
        }
        Verdict::Fail => {
            let each = diff.planes.iter().filter_map(|plane| {
                let what = plane.compared()?.differing(level);
                (!what.is_empty()).then_some((plane, what))
            });
            let each: Vec<_> = each.collect();
            let is_named = each
                .iter()
                .flat_map(|(_, what)| what)
                .any(|what| what != SLICES);
            let differing = each
                .iter()
                .map(|(plane, what)| format!("{} at {}", what.join(", "), plane.name));
            let differing = differing.collect::<Vec<String>>().join("; ");
            // A result of few photons lacks parameters of edges behind surfaces.
            let hint = if is_named || diff.scene.iter().all(is_of_run) {
                ""
            } else {
                "; no parameter of both results differs, but more photons may give more parameters"
            };
            format!("different: {differing} (α = {alpha} over all tests: p < {level:.1e}){hint}")
        }
        Verdict::Undecided => {
            let planes = diff.planes.iter();
            undecided(planes.filter_map(|plane| Some((&plane.name, plane.undecided(level)?))))
        }
    }
}

fn is_identical(plane: &PlaneDiff) -> bool {
    matches!(&plane.found, PlaneDifference::Compared(compared) if compared.is_identical)
}

fn has_same_bytes(diff: &Diff, plane: &PlaneDiff) -> bool {
    let [a, b] = &diff.results;
    a.hash(&plane.name) == b.hash(&plane.name)
}
