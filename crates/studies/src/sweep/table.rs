//! Writes the numbers of a sweep as one table in CSV. Each row has one number of one plane at one
//! point.

use crate::sweep::values::SweepPoint;
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

/// Returns the numbers of a plane: the numbers of its whole spectrum, and each parameter.
pub(crate) fn numbers(plane: &Value) -> Vec<TableNumber> {
    let of = |quantity: &str, unit: &str, of: &Value, predicted: &str| TableNumber {
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
            "cycles per unit slope, or per radian on surfaces",
            &bandwidth["nu"],
            "predicted",
        ),
        of(SLOPE, "m", &plane["slope"], "predicted"),
    ];
    let parameters = plane["parameters"].as_array().into_iter().flatten();
    numbers.extend(parameters.map(|p| of(&text(&p["name"]), &text(&p["unit"]), p, "scene")));
    numbers
}

/// A column of the table.
enum Column {
    Words(Vec<String>),
    /// Numbers; `None` for a cell without a number.
    Numbers(Vec<Option<f64>>),
}

/// The data of a row of the table: a number of a plane at a point.
struct TableRow<'a> {
    at: &'a PointResult,
    plane: &'a Value,
    number: TableNumber,
}

/// Returns the names and the contents of the columns: the swept fields, then the other data of
/// each row.
fn columns(paths: &[String], found: &[PointResult]) -> Vec<(String, Column)> {
    let planes = found
        .iter()
        .flat_map(|at| at.planes().map(move |plane| (at, plane)));
    let rows = planes.flat_map(|(at, plane)| {
        let numbers = numbers(plane).into_iter();
        numbers.map(move |number| TableRow { at, plane, number })
    });
    let rows: Vec<TableRow<'_>> = rows.collect();
    let words = |of: &dyn Fn(&TableRow<'_>) -> String| Column::Words(rows.iter().map(of).collect());
    let values =
        |of: &dyn Fn(&TableRow<'_>) -> Option<f64>| Column::Numbers(rows.iter().map(of).collect());
    let text = |key: &'static str| {
        words(&move |row| row.plane[key].as_str().unwrap_or_default().to_owned())
    };
    let share = |key: &'static str| values(&move |row| row.plane[key].as_f64());
    let swept = paths.iter().enumerate();
    let swept = swept.map(|(i, path)| (path.clone(), values(&|row| Some(row.at.point[i].1))));
    let rest = [
        ("point", words(&|row| row.at.folder.clone())),
        // Texts. Seeds are also texts, because a double cannot represent every seed exactly.
        ("seed", words(&|row| row.at.summary["seed"].to_string())),
        ("plane", text("name")),
        ("class", text("class")),
        ("verdict", text("verdict")),
        ("p_value", share("p_value")),
        (
            "radial_p_value",
            values(&|row| row.plane["radial"]["p_value"].as_f64()),
        ),
        ("relative_error", share("relative_error")),
        ("noise_limit", share("noise_limit")),
        ("quantity", words(&|row| row.number.quantity.clone())),
        ("unit", words(&|row| row.number.unit.clone())),
        ("measured", values(&|row| row.number.measured)),
        ("predicted", values(&|row| row.number.predicted)),
        ("error", values(&|row| row.number.error)),
    ];
    let rest = rest.map(|(name, column)| (name.to_owned(), column));
    swept.chain(rest).collect()
}

/// Returns the table as CSV with all digits; cells without a number are empty.
pub(crate) fn csv(paths: &[String], found: &[PointResult]) -> Result<Vec<u8>, Failure> {
    let columns = columns(paths, found);
    let mut writer = csv::Writer::from_writer(Vec::new());
    let names = columns.iter().map(|(name, _)| name);
    writer.write_record(names).map_err(Failure::cannot_run)?;
    let count = columns.first().map_or(0, |(_, column)| match column {
        Column::Words(words) => words.len(),
        Column::Numbers(numbers) => numbers.len(),
    });
    for row in 0..count {
        let cells = columns.iter().map(|(_, column)| match column {
            Column::Words(words) => words[row].clone(),
            Column::Numbers(numbers) => numbers[row].map_or(String::new(), |x| format!("{x:?}")),
        });
        writer.write_record(cells).map_err(Failure::cannot_run)?;
    }
    writer.into_inner().map_err(Failure::cannot_run)
}
