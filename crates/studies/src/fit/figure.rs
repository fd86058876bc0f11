//! Draws the ellipse of each pair of fitted fields.

use crate::fit::result::{Fitted, inverse};
use etendue_figures::{
    Axis, AxisQuantity, Ellipse, Ellipses, Figure, Picture, Scale, ellipses, stacked,
};
use etendue_store::Failure;
use ndarray::Array2;

/// The files of the figure.
pub const NAMES: [&str; 3] = ["fit.png", "fit.svg", "fit.csv"];

/// Number of cells along each axis.
const CELLS: usize = 48;
/// The largest number of pairs: those that are most correlated.
const MAX_PAIRS: usize = 6;
/// Extent of the axes, in standard errors.
const EXTENT: f64 = 3.5;

/// The relative likelihood over pairs of fields, with the ellipse of their errors and that of
/// the Cramér–Rao bound. `None` for one field, or if the fields are not determined.
pub fn drawn(scene: &str, fitted: &Fitted) -> Result<Option<Figure>, Failure> {
    let count = fitted.fields.len();
    let information = fitted.fisher_information.as_ref();
    let bound = information
        .and_then(|of| inverse(&Array2::from_shape_fn((count, count), |(i, j)| of[i][j])));
    let pairs = (0..count).flat_map(|i| (i + 1..count).map(move |j| [i, j]));
    let mut pairs: Vec<[usize; 2]> = pairs.collect();
    let correlation = |[i, j]: &[usize; 2]| {
        let row = fitted.correlations.get(*i);
        row.map_or(0.0, |row| row[*j].abs())
    };
    pairs.sort_by(|a, b| correlation(b).total_cmp(&correlation(a)));
    pairs.truncate(MAX_PAIRS);
    let figures = pairs
        .into_iter()
        .map(|pair| of_pair(scene, fitted, bound.as_ref(), pair));
    let figures: Option<Vec<Figure>> = figures.collect::<Result<_, _>>()?;
    Ok(figures
        .filter(|all| !all.is_empty())
        .map(|all| stacked(&all)))
}

fn of_pair(
    scene: &str,
    fitted: &Fitted,
    bound: Option<&Array2<f64>>,
    pair: [usize; 2],
) -> Result<Option<Figure>, Failure> {
    let [a, b] = pair.map(|i| &fitted.fields[i]);
    let (Some(of_a), Some(of_b)) = (a.error, b.error) else {
        return Ok(None);
    };
    let correlation = fitted.correlations[pair[0]][pair[1]];
    let cell = |i: usize| EXTENT * ((2 * i + 1) as f64 / CELLS as f64 - 1.0);
    let rest = 1.0 - correlation * correlation;
    let likelihood = Array2::from_shape_fn((CELLS, CELLS), |(i, j)| {
        let [x, y] = [cell(i), cell(j)];
        libm::exp(-0.5 * (x * x - 2.0 * correlation * x * y + y * y) / rest)
    });
    let axis = |field: &super::FittedField, error: f64| {
        let name = format!("{} − {}", field.field, etendue_field::brief(field.value));
        Axis::edges(&name, "", [-EXTENT * error, EXTENT * error])
    };
    let [i, j] = pair;
    let bound = bound.map(|bound| Ellipse {
        name: "Cramér–Rao bound, two standard deviations".to_owned(),
        covariance: [bound[[i, i]], bound[[i, j]], bound[[j, j]]],
    });
    let reached = Ellipse {
        name: "fit, two standard errors".to_owned(),
        covariance: [of_a * of_a, correlation * of_a * of_b, of_b * of_b],
    };
    let figure = ellipses(&Ellipses {
        title: &format!("{scene}: {} and {}", a.field, b.field),
        note: "",
        picture: Picture::new([axis(a, of_a), axis(b, of_b)], likelihood.view()),
        quantity: AxisQuantity::new("likelihood", ""),
        scale: Scale::Linear,
        ellipses: [bound, Some(reached), None],
    });
    figure.map(Some).map_err(Failure::cannot_run)
}
