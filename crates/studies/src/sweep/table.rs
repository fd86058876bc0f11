//! Writes the numbers of a sweep as one table in CSV. Each row has one number of one plane at one
//! point.

use crate::sweep::values::SweepPoint;
use etendue_report::table;
use etendue_store::Failure;
use serde_json::Value;

/// A number of a plane that is measured and predicted.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TableNumber {
    pub(crate) quantity: String,
    pub(crate) unit: String,
    pub(crate) measured: Option<f64>,
    pub(crate) predicted: Option<f64>,
    /// Standard error of the measured number.
    pub(crate) error: Option<f64>,
}

/// The values of a point of a sweep, and the `summary.json` of its run.
#[derive(Clone, Debug)]
pub(crate) struct PointResult {
    pub(crate) point: SweepPoint,
    pub(crate) folder: String,
    pub(crate) summary: Value,
}

impl PointResult {
    pub(crate) fn planes(&self) -> impl Iterator<Item = &Value> {
        self.summary["planes"].as_array().into_iter().flatten()
    }
}

/// Names of the numbers that every plane has.
pub(crate) const BANDWIDTHS: [&str; 2] = ["bandwidth_95_rho", "bandwidth_95_nu"];
pub(crate) const SLOPE: &str = "slope";

/// The unit of a number that every plane has.
pub(crate) fn unit_of(quantity: &str) -> &'static str {
    match quantity {
        SLOPE => "m",
        quantity if quantity == BANDWIDTHS[0] => "cycles/m",
        _ => "cycles per unit slope, or per radian on surfaces",
    }
}

/// The numbers of a plane: the numbers of its whole spectrum, and each parameter.
pub(crate) fn numbers(plane: &Value) -> Vec<TableNumber> {
    let own = |quantity: &str, unit: &str, of: &Value, predicted: &str| TableNumber {
        quantity: quantity.to_owned(),
        unit: unit.to_owned(),
        measured: of["measured"].as_f64(),
        predicted: of[predicted].as_f64(),
        error: of["error"].as_f64(),
    };
    let bandwidth = &plane["bandwidth_95"];
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let whole = [
        (BANDWIDTHS[0], &bandwidth["rho"]),
        (BANDWIDTHS[1], &bandwidth["nu"]),
        (SLOPE, &plane["slope"]),
    ];
    let whole = whole.map(|(name, of)| own(name, unit_of(name), of, "predicted"));
    let mut numbers = Vec::from(whole);
    let parameters = plane["parameters"].as_array().into_iter().flatten();
    numbers.extend(parameters.map(|p| own(&text(&p["name"]), &text(&p["unit"]), p, "scene")));
    numbers
}

/// The table as CSV with all digits; cells without a number are empty.
pub(crate) fn csv(paths: &[String], found: &[PointResult]) -> Result<Vec<u8>, Failure> {
    // Seeds are texts, because a double cannot represent every seed exactly.
    let names = [
        "point",
        "seed",
        "plane",
        "class",
        "verdict",
        "p_value",
        "radial_p_value",
        "relative_error",
        "noise_limit",
        "quantity",
        "unit",
        "measured",
        "predicted",
        "error",
    ];
    let header: Vec<String> = paths
        .iter()
        .cloned()
        .chain(names.map(str::to_owned))
        .collect();
    let digits = |number: Option<f64>| number.map_or(String::new(), |x| format!("{x:?}"));
    let row = |at: &PointResult, plane: &Value, number: TableNumber| {
        let text = |key: &str| plane[key].as_str().unwrap_or_default().to_owned();
        let share = |key: &str| digits(plane[key].as_f64());
        let swept = at.point.iter().map(|(_, value)| digits(Some(*value)));
        let rest = [
            at.folder.clone(),
            at.summary["seed"].to_string(),
            text("name"),
            text("class"),
            text("verdict"),
            share("p_value"),
            digits(plane["radial"]["p_value"].as_f64()),
            share("relative_error"),
            share("noise_limit"),
            number.quantity,
            number.unit,
            digits(number.measured),
            digits(number.predicted),
            digits(number.error),
        ];
        swept.chain(rest).collect()
    };
    let planes = found
        .iter()
        .flat_map(|at| at.planes().map(move |plane| (at, plane)));
    let rows = planes.flat_map(|(at, plane)| {
        let numbers = numbers(plane).into_iter();
        numbers.map(move |number| row(at, plane, number))
    });
    table::csv(&header, rows)
}
