//! The numbers of a sweep as one table, a row for each number of each plane at each point.

use crate::failure::Failure;
use crate::values::Point;
use serde_json::Value;

/// A number of a plane that is measured and predicted.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Number {
    pub(crate) quantity: String,
    pub(crate) unit: String,
    pub(crate) measured: Option<f64>,
    pub(crate) predicted: Option<f64>,
    /// Of what is measured.
    pub(crate) error: Option<f64>,
}

/// A point of a sweep, and the `summary.json` of its run.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    pub(crate) point: Point,
    pub(crate) folder: String,
    pub(crate) summary: Value,
}

impl Found {
    pub(crate) fn planes(&self) -> impl Iterator<Item = &Value> {
        self.summary["planes"].as_array().into_iter().flatten()
    }
}

/// Names of the numbers that every plane has.
pub(crate) const BANDWIDTHS: [&str; 2] = ["bandwidth_95_rho", "bandwidth_95_nu"];
pub(crate) const SLOPE: &str = "slope";

/// The numbers of a plane: of its whole spectrum, and each parameter.
pub(crate) fn numbers(plane: &Value) -> Vec<Number> {
    let of = |quantity: &str, unit: &str, of: &Value, predicted: &str| Number {
        quantity: quantity.to_owned(),
        unit: unit.to_owned(),
        measured: of["measured"].as_f64(),
        predicted: of[predicted].as_f64(),
        error: of["error"].as_f64(),
    };
    let bandwidth = &plane["bandwidth_95"];
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let mut numbers = vec![
        of(BANDWIDTHS[0], "cycles/m", &bandwidth["rho"], "predicted"),
        of(
            BANDWIDTHS[1],
            "cycles per unit slope, on surfaces per radian",
            &bandwidth["nu"],
            "predicted",
        ),
        of(SLOPE, "m", &plane["slope"], "predicted"),
    ];
    let parameters = plane["parameters"].as_array().into_iter().flatten();
    numbers.extend(parameters.map(|p| of(&text(&p["name"]), &text(&p["unit"]), p, "scene")));
    numbers
}

/// The table as CSV, all digits, empty where there is no number.
pub(crate) fn csv(paths: &[String], found: &[Found]) -> Result<Vec<u8>, Failure> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut write = |row: Vec<String>| writer.write_record(row).map_err(Failure::cannot_run);
    let columns = [
        "point",
        "plane",
        "class",
        "verdict",
        "p_value",
        "relative_error",
        "noise_limit",
        "quantity",
        "unit",
        "measured",
        "predicted",
        "error",
    ];
    write(
        paths
            .iter()
            .cloned()
            .chain(columns.map(str::to_owned))
            .collect(),
    )?;
    for at in found {
        for plane in at.planes() {
            for number in numbers(plane) {
                let mut row: Vec<String> = at.point.iter().map(|(_, x)| x.to_string()).collect();
                row.push(at.folder.clone());
                let words = ["name", "class", "verdict"].map(|key| plane[key].as_str());
                row.extend(words.map(|word| word.unwrap_or_default().to_owned()));
                let shares = ["p_value", "relative_error", "noise_limit"];
                row.extend(shares.map(|key| digits(plane[key].as_f64())));
                row.extend([number.quantity, number.unit]);
                row.extend([number.measured, number.predicted, number.error].map(digits));
                write(row)?;
            }
        }
    }
    writer.into_inner().map_err(Failure::cannot_run)
}

fn digits(number: Option<f64>) -> String {
    number.map_or(String::new(), |x| format!("{x:?}"))
}
