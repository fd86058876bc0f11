//! Draws values that have names instead of positions along an axis.

use crate::axis::{Axis, AxisQuantity, upright_ticks};
use crate::curves::{Curve, CurveKind, draw_curve, key, layered};
use crate::figure::{Error, Figure, csv_text, decimal};
use crate::grid::LEFT;
use crate::panel::Panel;
use crate::sizes::{TICK_BASELINE, TICK_TEXT};
use crate::style::Style;
use crate::svg::{Anchor, Area, Svg, TextStyle};
use crate::text::{fit, plain, width};

/// Values with names, beside each other in one frame whose scale begins at 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// Title, markup.
    pub title: String,
    /// A line below the title, as markup.
    pub note: String,
    /// The quantity of the values.
    pub y: AxisQuantity,
    /// The names, from left to right.
    pub names: Vec<String>,
    /// The values: points (number of the name, from 0; value; standard error). Points may be moved
    /// aside by a part of 1. Each value of a theory has a short stroke of its own; a rival is a line.
    pub curves: Vec<Curve>,
}

/// Height of the frame.
const HEIGHT: f64 = 200.0;
/// Width that is reserved for a name.
const NAME_WIDTH: f64 = 96.0;
const RIGHT: f64 = 20.0;
/// Distance between the names and the lower edge of the page.
const BELOW: f64 = 14.0;
/// Distance between names.
const BETWEEN: f64 = 6.0;
/// Width of tick texts that fits beside the frame.
const TICK_WIDTH: f64 = 28.0;
/// Minimum number of names that give the width of the frame, so that the title fits.
const MIN_NAMES: usize = 4;

/// Draws the chart. The CSV has a row for each value.
///
/// # Errors
/// If the numbers cannot be written.
pub fn chart(chart: &Chart, style: &Style) -> Result<Figure, Error> {
    let points = || chart.curves.iter().flat_map(|curve| &curve.points);
    let most = points().map(|p| p[1] + p[2]).fold(0.0, f64::max);
    let y = Axis::of(&chart.y, [0.0, 1.06 * most]);
    let x = Axis::edges("", "", [-0.5, chart.names.len() as f64 - 0.5]);
    let ticks = upright_ticks(&y, HEIGHT).into_iter();
    let widest = ticks.map(|tick| width(&tick.text, TICK_TEXT));
    let left = LEFT + (widest.fold(0.0, f64::max) - TICK_WIDTH).max(0.0);
    let inner =
        (NAME_WIDTH * chart.names.len().max(MIN_NAMES) as f64).min(style.page() - left - RIGHT);
    let mut svg = Svg::default();
    let top = style.title(&mut svg, left, inner, &chart.title, &chart.note);
    let top = key(&mut svg, chart.curves.iter(), [left, top + 16.0], inner) + 20.0;
    let area = Area::new([left, top], [inner, HEIGHT]);
    let frame = Panel::new(area, &x, &y);
    svg.clipped(area, |svg| {
        for Curve { kind, points, .. } in layered(&chart.curves) {
            let points: Vec<&[f64; 3]> = points.iter().collect();
            // A line joins the values of a rival alone.
            let joined = if *kind == CurveKind::Rival {
                points.len()
            } else {
                1
            };
            for points in points.chunks(joined.max(1)) {
                draw_curve(svg, &frame, *kind, points);
            }
        }
    });
    frame.frame(&mut svg);
    names(&mut svg, &chart.names, &frame);
    let bottom = area.bottom() + TICK_BASELINE + BELOW;
    let svg = svg.finish(left + inner + RIGHT, bottom);
    Ok(Figure::new(svg, numbers(chart)?))
}

/// Writes the names below the frame.
fn names(svg: &mut Svg, names: &[String], frame: &Panel<'_>) {
    let room = frame.area.width / names.len() as f64 - BETWEEN;
    for (i, name) in names.iter().enumerate() {
        let [at, bottom] = frame.point(i as f64, 0.0);
        let (text, size) = fit(name, TICK_TEXT, room);
        let place = [at, bottom + TICK_BASELINE];
        svg.text(TextStyle::new(place, size, Anchor::Middle), &text);
    }
}

/// The CSV, with a row for each value of each name.
fn numbers(chart: &Chart) -> Result<String, Error> {
    let header = ["name", "curve", &chart.y.heading(), "error"].map(str::to_owned);
    let row = |curve: &Curve, [x, y, error]: &[f64; 3]| {
        let name = chart.names.get(etendue_field::whole(x + 0.5));
        vec![
            name.cloned().unwrap_or_default(),
            plain(&curve.name),
            decimal(y),
            decimal(error),
        ]
    };
    let rows = chart.curves.iter().flat_map(|curve| {
        let points = curve.points.iter();
        points.map(move |point| row(curve, point))
    });
    csv_text(&header, rows)
}
