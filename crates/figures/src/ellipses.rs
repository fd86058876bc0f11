//! Draws a spectrum with ellipses of covariances over it.

use crate::axis::AxisQuantity;
use crate::bar;
use crate::color::{Colors, Scale, largest};
use crate::figure::{Error, Figure, csv_text, decimal};
use crate::panel::Panel;
use crate::picture::Picture;
use crate::sizes::{INK, LABEL_BASELINE, TICK_TEXT};
use crate::svg::{Anchor, Area, Stroke, Svg, TextStyle};
use std::f64::consts::TAU;

/// A covariance over the two axes of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Ellipse {
    /// The name of the ellipse in the key.
    pub name: String,
    /// The entries xx, xy and yy of the covariance.
    pub covariance: [f64; 3],
}

/// A spectrum with at most three covariances.
#[derive(Clone, Debug)]
pub struct Ellipses<'a> {
    /// The title; markup.
    pub title: &'a str,
    /// A line below the title, as markup; may be empty.
    pub note: &'a str,
    /// The power of the spectrum.
    pub picture: Picture<'a>,
    /// The quantity of the picture.
    pub quantity: AxisQuantity,
    /// The color scale of the spectrum, relative to its largest value.
    pub scale: Scale,
    /// The ellipses at two standard deviations, in the order of the key. Each position in this list
    /// has its own color and dashes. If an ellipse is missing, no other ellipse takes its color and
    /// dashes.
    pub ellipses: [Option<Ellipse>; 3],
}

impl Ellipses<'_> {
    /// The ellipses that are not missing, each with its color and dashes.
    fn drawn(&self) -> impl Iterator<Item = (&Ellipse, &'static str, &'static str)> {
        let all = self.ellipses.iter().zip(STROKES);
        all.filter_map(|(ellipse, (color, dash))| Some((ellipse.as_ref()?, color, dash)))
    }

    /// The strokes over the picture in drawing order: all halos, then solid lines, then
    /// dashes. In this order, ellipses that coincide are all visible.
    fn strokes(&self) -> impl Iterator<Item = (&Ellipse, Stroke)> {
        let halo = Stroke::solid(HALO, 3.4);
        let halos = self.drawn().map(move |(ellipse, ..)| (ellipse, halo));
        let lines = |broken: bool| {
            let drawn = self
                .drawn()
                .filter(move |(.., dash)| dash.is_empty() != broken);
            drawn.map(|(ellipse, color, dash)| {
                let line = Stroke::solid(color, 1.6);
                (ellipse, Stroke { dash, ..line })
            })
        };
        halos.chain(lines(false)).chain(lines(true))
    }
}

const SIDE: f64 = 320.0;
const LEFT: f64 = 66.0;
/// Line spacing of the key.
const LINE: f64 = 17.0;
/// Number of standard deviations at which an ellipse is drawn.
const DEVIATIONS: f64 = 2.0;
/// Color of the halo below each ellipse, which makes the ellipse visible on pale backgrounds.
const HALO: &str = "#10304a";
/// Colors and dashes of the ellipses; no two ellipses share a color or dashes.
const STROKES: [(&str, &str); 3] = [("#7fe0ff", "7 4"), ("#ffffff", ""), ("#8dff9c", "2 3")];

/// Draws a spectrum with ellipses.
///
/// The CSV has a row for each covariance, followed by a row for each cell.
///
/// # Errors
/// If the heat map or the numbers cannot be written.
pub fn ellipses(of: &Ellipses<'_>) -> Result<Figure, Error> {
    let mut svg = Svg::default();
    let width = LEFT + SIDE + 10.0 + bar::WIDTH + 60.0;
    let top = svg.title(LEFT, width - LEFT - 10.0, of.title, of.note) + 10.0;
    let area = Area::new([LEFT, top], [SIDE, SIDE]);
    let panel = Panel::new(area, &of.picture.x, &of.picture.y);
    let values = of.picture.values;
    let name = format!("{} relative to its peak", of.quantity.name);
    let peak = largest(values);
    let shading = of
        .scale
        .shading(Colors::MAGNITUDES, &of.quantity, peak, &name);
    let shading = shading.showing(values);
    panel.heat_map(&mut svg, values, &shading)?;
    svg.clipped(area, |svg| {
        for stroke in of.strokes() {
            let points = points(stroke.0.covariance).map(|[x, y]| panel.point(x, y));
            svg.polyline(&points.collect::<Vec<_>>(), stroke.1);
        }
    });
    panel.axes(&mut svg);
    bar::draw(&mut svg, &shading, area.right() + 10.0, area, 12.0)?;
    let mut baseline = area.bottom() + LABEL_BASELINE + 8.0;
    for (ellipse, color, dash) in of.drawn() {
        baseline += LINE;
        let [from, to] = [LEFT, LEFT + 34.0].map(|x| [x, baseline - 4.0]);
        let line = Stroke::solid(color, 2.0);
        svg.line(from, to, Stroke::solid(HALO, 5.0));
        svg.line(from, to, Stroke { dash, ..line });
        let style = TextStyle::new([LEFT + 44.0, baseline], TICK_TEXT, Anchor::Start).fill(INK);
        svg.fitted(style, &ellipse.name, width - LEFT - 54.0);
    }
    let svg = svg.finish(width, baseline + 13.0);
    Ok(Figure::new(svg, numbers(of)?))
}

/// Returns points around the ellipse of a covariance. The points are a matrix square root of the
/// covariance times points of a circle.
fn points([xx, xy, yy]: [f64; 3]) -> impl Iterator<Item = [f64; 2]> {
    const CORNERS: u32 = 180;
    let a = xx.max(0.0).sqrt();
    let b = if a > 0.0 { xy / a } else { 0.0 };
    let c = (yy - b * b).max(0.0).sqrt();
    (0..=CORNERS).map(move |i| {
        let (sin, cos) = libm::sincos(TAU * f64::from(i) / f64::from(CORNERS));
        [a * cos, b * cos + c * sin].map(|t| DEVIATIONS * t)
    })
}

/// Two tables: the covariances, and the cells with x varying slowest.
fn numbers(of: &Ellipses<'_>) -> Result<String, Error> {
    let [a, b] = of.picture.headings();
    let header = [
        "covariance".to_owned(),
        format!("{a}²"),
        format!("{a} · {b}"),
        format!("{b}²"),
    ];
    let rows = of.drawn().map(|(ellipse, ..)| {
        let entries = ellipse.covariance.iter().map(decimal);
        std::iter::once(ellipse.name.clone())
            .chain(entries)
            .collect()
    });
    let covariances = csv_text(&header, rows)?;
    let cells = of.picture.cells().into_iter().map(Vec::from);
    let cells = csv_text(&[a, b, of.quantity.heading()], cells)?;
    Ok(format!("{covariances}\n{cells}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_lie_two_deviations_out() {
        let [xx, xy, yy] = [4.0, -3.0, 9.0];
        let determinant = xx * yy - xy * xy;
        let mut highest = 0.0_f64;
        for [x, y] in points([xx, xy, yy]) {
            let square = (yy * x * x - 2.0 * xy * x * y + xx * y * y) / determinant;
            assert!((square - 4.0).abs() < 1e-12); // rounding
            highest = highest.max(y);
        }
        // The ellipse extends to two standard deviations of y, up to the error of its polygon.
        assert!((highest - 6.0).abs() < 6.0 * 2e-4, "{highest}");
        // If a spectrum has no width, its ellipse is a line.
        assert!(points([1.0, -2.0, 4.0]).all(|[x, y]| (y + 2.0 * x).abs() < 1e-12)); // rounding
    }
}
