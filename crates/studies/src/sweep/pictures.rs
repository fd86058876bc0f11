//! Draws the curves of a sweep: each plane's numbers as functions of the first field.

use crate::sweep::differences::PointDifferences;
use crate::sweep::table::{BANDWIDTHS, PointResult, SLOPE, TableNumber, numbers};
use crate::sweep::values::{SweepPoint, short, shown};
use etendue_figures::{AxisQuantity, Curve, CurveKind, CurvePanel, Curves, Figure, Style};
use etendue_report::table::spaced;
use etendue_store::Failure;

/// Names of the picture files, without extensions.
pub(crate) const NAMES: [&str; 3] = ["bandwidth_rho", "bandwidth_nu", "slope"];

/// The largest useful number of panels in a picture.
const MAX_PANELS: usize = 24;

/// Draws the pictures of [`NAMES`], unless the pictures would have too many panels. If several
/// fields are swept, each combination of values of the fields after the first has its own panel.
#[expect(clippy::too_many_lines, reason = "the steps of one drawing, in order")]
pub(crate) fn drawn(
    scene: &str,
    found: &[PointResult],
    together: bool,
    differences: &PointDifferences,
) -> Result<Vec<Figure>, Failure> {
    let mut panels: Vec<(String, SweepPoint)> = Vec::new();
    for (at, plane) in found
        .iter()
        .flat_map(|at| at.planes().map(move |plane| (at, plane)))
    {
        let panel = (name(plane).to_owned(), others(at, together));
        if !panels.contains(&panel) {
            panels.push(panel);
        }
    }
    if panels.len() > MAX_PANELS {
        return Ok(Vec::new());
    }
    let quantities = [
        (
            BANDWIDTHS[0],
            "*ρ* below which 95 % of the power lies",
            AxisQuantity::new("*ρ*_{95}", "cycles/m"),
        ),
        (
            BANDWIDTHS[1],
            "*ν* below which 95 % of the power lies",
            AxisQuantity::new("*ν*_{95}", "cycles/slope"),
        ),
        (SLOPE, "shear slope", AxisQuantity::new("shear slope", "m")),
    ];
    let fields: Vec<&str> = found[0]
        .point
        .iter()
        .map(|(path, _)| path.as_str())
        .collect();
    let mut note = "Error bars: one standard error.".to_owned();
    if together && fields.len() > 1 {
        note += &format!(
            " The field varies together with {}.",
            fields[1..].join(", ")
        );
    }
    if short(fields[0]) != fields[0] {
        note += &format!(" {}: {}.", short(fields[0]), fields[0]);
    }
    let figure = |(quantity, about, y): (&str, &str, AxisQuantity)| {
        let panel = |(plane, others): &(String, SweepPoint)| {
            let at = found
                .iter()
                .filter(|at| self::others(at, together) == *others);
            let of_plane = |at: &PointResult| {
                let of_plane = at.planes().find(|p| name(p) == plane)?;
                let number = numbers(of_plane)
                    .into_iter()
                    .find(|n| n.quantity == quantity)?;
                let of = [&at.folder, name(of_plane), quantity];
                Some((at.point[0].1, number, differences.error(of)))
            };
            let mut numbers: Vec<_> = at.filter_map(of_plane).collect();
            // The values are sorted, because lists may give the values in any order.
            numbers.sort_by(|a, b| a.0.total_cmp(&b.0));
            panel(plane, others, &found[0].point[0].0, &numbers)
        };
        let curves = Curves {
            title: format!("{}: {about}", spaced(scene)),
            note: note.clone(),
            y,
            panels: panels.iter().map(panel).collect(),
        };
        etendue_figures::curves(&curves, &Style::default()).map_err(Failure::cannot_run)
    };
    quantities.into_iter().map(figure).collect()
}

/// A panel with the measured and predicted numbers of a plane over the swept field.
fn panel(
    plane: &str,
    others: &SweepPoint,
    path: &str,
    numbers: &[(f64, TableNumber, Option<f64>)],
) -> CurvePanel {
    let curve = |kind, name: &str, point: &dyn Fn(&TableNumber) -> Option<[f64; 2]>| {
        let points = numbers
            .iter()
            .filter_map(|(x, number, _)| point(number).map(|[y, error]| [*x, y, error]));
        Curve::new(kind, name, points.collect())
    };
    let changes = numbers.iter();
    let changes = changes.filter_map(|(x, number, error)| Some([*x, number.measured?, (*error)?]));
    let changes: Vec<_> = changes.collect();
    let predicted = |number: &TableNumber| Some([number.predicted?, 0.0]);
    let measured = |number: &TableNumber| Some([number.measured?, number.error.unwrap_or(0.0)]);
    let mut curves = vec![
        curve(CurveKind::Theory, "predicted", &predicted),
        curve(CurveKind::Measured, "measured", &measured),
    ];
    if !changes.is_empty() {
        curves.push(Curve::new(
            CurveKind::Change,
            "error of the change from the point before",
            changes,
        ));
    }
    let others = others
        .iter()
        .map(|(path, value)| (short(path).to_owned(), *value));
    let title = match shown(&others.collect()).as_str() {
        "" => spaced(plane),
        others => format!("{}, {others}", spaced(plane)),
    };
    CurvePanel {
        title,
        x: AxisQuantity::new(short(path), etendue_scene::unit(path)),
        is_log: [go_by_factors(numbers.iter().map(|(x, ..)| *x)), false],
        curves,
    }
}

/// Checks whether there are at least three values, and the values grow by equal factors.
fn go_by_factors(values: impl Iterator<Item = f64>) -> bool {
    // The relative rounding error of the values of a range, with a margin.
    const ROUNDING: f64 = 1e-6;
    let mut values: Vec<f64> = values.collect();
    values.dedup();
    let factors: Vec<f64> = values.windows(2).map(|pair| pair[1] / pair[0]).collect();
    let even = factors
        .iter()
        .all(|f| (f / factors[0] - 1.0).abs() < ROUNDING);
    values.first().is_some_and(|first| *first > 0.0) && factors.len() >= 2 && even
}

fn name(plane: &serde_json::Value) -> &str {
    plane["name"].as_str().unwrap_or_default()
}

/// The values that distinguish one panel from another.
fn others(at: &PointResult, together: bool) -> SweepPoint {
    if together {
        SweepPoint::new()
    } else {
        at.point[1..].to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::go_by_factors;

    #[test]
    fn equal_factors_are_told_from_equal_steps() {
        let by_factors = |values: &[f64]| go_by_factors(values.iter().copied());
        assert!(by_factors(&[1.0, 10.0, 10.0, 100.0]));
        assert!(by_factors(&[0.05, 0.1, 0.2]));
        for other in [&[1.0, 2.0, 3.0][..], &[1.0, 2.0], &[-4.0, -2.0, -1.0], &[]] {
            assert!(!by_factors(other), "{other:?}");
        }
    }
}
