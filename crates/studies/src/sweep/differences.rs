//! Measures the differences of neighbouring points of a sweep whose points have one seed, in pairs of
//! batches.

use crate::sweep::table::PointResult;
use etendue_report::diff::{Diff, json};
use etendue_report::table;
use etendue_store::Failure;
use serde_json::Value;
use std::path::Path;

/// The level at which a difference counts; the table has every difference.
const ALPHA: f64 = 0.01;

/// The header of the table. The first columns name the two points.
const HEADER: [&str; 15] = [
    "from",
    "to",
    "plane",
    "verdict",
    "p_value",
    "difference",
    "noise",
    "unpaired_noise",
    "p_value_of_predicted_difference",
    "parameter",
    "unit",
    "change",
    "error",
    "p_value_of_change",
    "p_value_of_rest",
];

/// A table as CSV: a row for each plane of each two neighbours, and for each parameter of the plane.
/// Two points are neighbours if one follows the other and only one field has another value, or if
/// all fields vary together. Points of earlier sweeps that have no batches are left out.
pub(super) fn csv(
    folder: &Path,
    found: &[PointResult],
    together: bool,
) -> Result<Vec<u8>, Failure> {
    let mut rows = Vec::new();
    for pair in found.windows(2) {
        let [a, b] = [&pair[0], &pair[1]];
        let values = a.point.iter().zip(&b.point);
        let changes = values.filter(|(a, b)| a != b).count();
        if changes != 1 && !together {
            continue;
        }
        let folders = [a, b].map(|point| folder.join(&point.folder));
        let diff = json(&Diff::read(
            folders.each_ref().map(|of| of.as_path()),
            ALPHA,
        )?);
        if diff["pairs"] != true {
            continue;
        }
        let planes = diff["planes"].as_array().into_iter().flatten();
        rows.extend(planes.flat_map(|plane| of_plane([&a.folder, &b.folder], plane)));
    }
    table::csv(&HEADER.map(str::to_owned), rows)
}

fn of_plane(folders: [&String; 2], plane: &Value) -> Vec<Vec<String>> {
    let cell = |of: &Value, key: &str| match &of[key] {
        Value::String(text) => text.clone(),
        Value::Null => String::new(),
        number => number.to_string(),
    };
    let mut first: Vec<String> = folders.map(String::clone).into();
    first.push(cell(plane, "name"));
    first.extend(HEADER[3..9].iter().map(|key| cell(plane, key)));
    let parameters = plane["parameters"].as_array().into_iter().flatten();
    let rows = parameters.map(|parameter| {
        let measured = &parameter["measured"];
        let [a, b] = [0, 1].map(|i| measured[i]["value"].as_f64().unwrap_or(f64::NAN));
        let numbers = [
            cell(parameter, "name"),
            cell(parameter, "unit"),
            format!("{:?}", b - a),
            cell(&measured[1], "error"),
            cell(parameter, "p_value"),
            cell(parameter, "p_value_of_rest"),
        ];
        [first.clone(), numbers.into()].concat()
    });
    let mut rows: Vec<_> = rows.collect();
    if rows.is_empty() {
        let none = HEADER[9..].iter().map(|_| String::new());
        rows.push([first, none.collect()].concat());
    }
    rows
}
