//! Curves of a sweep: what each plane's numbers do along its first field.

use crate::failure::Failure;
use crate::sweep::table::{BANDWIDTHS, Found, Number, SLOPE, numbers};
use crate::table::spaced;
use crate::values::{Point, shown};
use etendue_figures::{Curve, CurveKind, CurvePanel, Curves, Figure, Quantity, curves};

/// Names of the pictures, without their endings.
pub(crate) const NAMES: [&str; 3] = ["bandwidth_rho", "bandwidth_nu", "slope"];

/// Panels of a picture, beyond which nobody looks at them.
const MOST: usize = 24;

/// The pictures of [`NAMES`], unless they would have too many panels. Of a grid of several fields
/// there is a panel for each value of all but the first.
pub(crate) fn drawn(scene: &str, found: &[Found], together: bool) -> Result<Vec<Figure>, Failure> {
    let mut panels: Vec<(String, Point)> = Vec::new();
    for (at, plane) in found
        .iter()
        .flat_map(|at| at.planes().map(move |plane| (at, plane)))
    {
        let panel = (name(plane).to_owned(), others(at, together));
        if !panels.contains(&panel) {
            panels.push(panel);
        }
    }
    if panels.len() > MOST {
        return Ok(Vec::new());
    }
    let quantities = [
        (
            BANDWIDTHS[0],
            Quantity::new("*ρ* of 95 % of the power", "cycles/m"),
        ),
        (
            BANDWIDTHS[1],
            Quantity::new("*ν* of 95 % of the power", "cycles/slope"),
        ),
        (SLOPE, Quantity::new("shear slope", "m")),
    ];
    let fields: Vec<&str> = found[0]
        .point
        .iter()
        .map(|(path, _)| path.as_str())
        .collect();
    let mut note = "Error bars: one standard error.".to_owned();
    if together && fields.len() > 1 {
        note += &format!(" In step with {}.", fields[1..].join(", "));
    }
    let figure = |(quantity, y): (&str, Quantity)| {
        let panel = |(plane, others): &(String, Point)| {
            let at = found
                .iter()
                .filter(|at| self::others(at, together) == *others);
            let of_plane = |at: &Found| {
                let plane = at.planes().find(|p| name(p) == plane)?;
                let number = numbers(plane)
                    .into_iter()
                    .find(|n| n.quantity == quantity)?;
                Some((at.point[0].1, number))
            };
            let mut numbers: Vec<(f64, Number)> = at.filter_map(of_plane).collect();
            // Lists come in any order.
            numbers.sort_by(|a, b| a.0.total_cmp(&b.0));
            panel(plane, others, &found[0].point[0].0, &numbers)
        };
        curves(&Curves {
            title: format!("{}: {}", spaced(scene), y.name),
            note: note.clone(),
            y,
            panels: panels.iter().map(panel).collect(),
        })
        .map_err(Failure::cannot_run)
    };
    quantities.into_iter().map(figure).collect()
}

/// Measured and predicted numbers of a plane over the field that is swept.
fn panel(plane: &str, others: &Point, path: &str, numbers: &[(f64, Number)]) -> CurvePanel {
    let curve = |kind, name: &str, point: &dyn Fn(&Number) -> Option<[f64; 2]>| Curve {
        kind,
        name: name.to_owned(),
        points: numbers
            .iter()
            .filter_map(|(x, number)| point(number).map(|[y, error]| [*x, y, error]))
            .collect(),
    };
    let predicted = |number: &Number| Some([number.predicted?, 0.0]);
    let measured = |number: &Number| Some([number.measured?, number.error.unwrap_or(0.0)]);
    let title = match shown(others).as_str() {
        "" => spaced(plane),
        others => format!("{}, {others}", spaced(plane)),
    };
    CurvePanel {
        title,
        x: Quantity::new(path, ""),
        curves: vec![
            curve(CurveKind::Theory, "predicted", &predicted),
            curve(CurveKind::Measured, "measured", &measured),
        ],
    }
}

fn name(plane: &serde_json::Value) -> &str {
    plane["name"].as_str().unwrap_or_default()
}

/// The values that tell one panel from another.
fn others(at: &Found, together: bool) -> Point {
    if together {
        Point::new()
    } else {
        at.point[1..].to_vec()
    }
}
