//! Measures the differences of neighbouring points of a sweep whose points have one seed, in pairs of
//! batches.

use crate::sweep::table::{BANDWIDTHS, PointResult, SLOPE, unit_of};
use etendue_compare::paired_changes;
use etendue_pipeline::stored_batches;
use etendue_report::diff::{Diff, json};
use etendue_report::table;
use etendue_scene::Scene;
use etendue_spectrum::{Measurement, Uncertain};
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

/// The differences of neighbouring points. Two points are neighbours if one follows the other and
/// only one field has another value, or if all fields vary together.
#[derive(Clone, Debug, Default)]
pub(super) struct PointDifferences {
    /// A row for each plane of each two neighbours, and for each number of the plane.
    rows: Vec<Vec<String>>,
    /// The folder of a point, a plane, and one of the numbers that every plane has, with the
    /// standard error of its change from the point before.
    errors: Vec<([String; 3], f64)>,
}

impl PointDifferences {
    /// Reads the batches of all points. Points of earlier sweeps that have no batches are left out.
    pub(super) fn read(
        folder: &Path,
        (found, scenes): (&[PointResult], &[Scene]),
        together: bool,
    ) -> Result<Self, Failure> {
        let mut all = Self::default();
        // The batches of the point before, if they are read.
        let mut before: Option<Measurement> = None;
        for (pair, scenes) in found.windows(2).zip(scenes.windows(2)) {
            let [a, b] = [&pair[0], &pair[1]];
            let values = a.point.iter().zip(&b.point);
            let changes = values.filter(|(a, b)| a != b).count();
            let earlier = before.take();
            if changes != 1 && !together {
                continue;
            }
            let folders = [a, b].map(|point| folder.join(&point.folder));
            let diff = json(&Diff::read(
                folders.each_ref().map(|of| of.as_path()),
                ALPHA,
            )?);
            if diff["pairs"] == true {
                let of_a = match earlier {
                    Some(read) => read,
                    None => stored_batches(&folders[0], &scenes[0])?,
                };
                let of_b = stored_batches(&folders[1], &scenes[1])?;
                all.add([a, b], &diff, [&of_a, &of_b])?;
                before = Some(of_b);
            }
        }
        Ok(all)
    }

    fn add(
        &mut self,
        points: [&PointResult; 2],
        diff: &Value,
        measured: [&Measurement; 2],
    ) -> Result<(), Failure> {
        let [from, to] = points.map(|point| &point.folder);
        let planes = diff["planes"].as_array().into_iter().flatten();
        for (i, plane) in planes.enumerate() {
            let mut first = vec![from.clone(), to.clone(), cell(plane, "name")];
            first.extend(HEADER[3..9].iter().map(|key| cell(plane, key)));
            let before = self.rows.len();
            let changes = paired_changes(measured, i).map_err(Failure::cannot_run)?;
            let names = [BANDWIDTHS[0], BANDWIDTHS[1], SLOPE];
            for (name, change) in names.into_iter().zip(changes) {
                let Some(Uncertain { value, error }) = change else {
                    continue;
                };
                let unit = unit_of(name);
                let [value, shown] = [value, error].map(|number| format!("{number:?}"));
                let none = String::new();
                let numbers = [
                    name.to_owned(),
                    unit.to_owned(),
                    value,
                    shown,
                    none.clone(),
                    none,
                ];
                self.rows.push([first.clone(), numbers.into()].concat());
                let key = [to.clone(), cell(plane, "name"), name.to_owned()];
                self.errors.push((key, error));
            }
            let parameters = plane["parameters"].as_array().into_iter().flatten();
            let parameters = parameters.map(|of| [first.clone(), of_parameter(of).into()].concat());
            self.rows.extend(parameters);
            if self.rows.len() == before {
                let none = HEADER[9..].iter().map(|_| String::new());
                self.rows.push([first, none.collect()].concat());
            }
        }
        Ok(())
    }

    /// The table as CSV.
    pub(super) fn csv(self) -> Result<Vec<u8>, Failure> {
        table::csv(&HEADER.map(str::to_owned), self.rows)
    }

    /// The standard error of the change of a number from the point before to the point in a folder.
    pub(super) fn error(&self, of: [&str; 3]) -> Option<f64> {
        let found = self.errors.iter().find(|(key, _)| *key == of)?;
        Some(found.1)
    }
}

fn cell(of: &Value, key: &str) -> String {
    match &of[key] {
        Value::String(text) => text.clone(),
        Value::Null => String::new(),
        number => number.to_string(),
    }
}

/// The columns of a parameter.
fn of_parameter(parameter: &Value) -> [String; 6] {
    let measured = &parameter["measured"];
    let [a, b] = [0, 1].map(|i| measured[i]["value"].as_f64().unwrap_or(f64::NAN));
    [
        cell(parameter, "name"),
        cell(parameter, "unit"),
        format!("{:?}", b - a),
        cell(&measured[1], "error"),
        cell(parameter, "p_value"),
        cell(parameter, "p_value_of_rest"),
    ]
}
