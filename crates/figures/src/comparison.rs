//! Draws one quantity from two sources, such as measured | predicted | difference in σ.

use crate::axis::{Axis, AxisQuantity};
use crate::bar;
use crate::color::{Colors, Scale, Shading, has_gaps, largest};
use crate::figure::{Error, Figure, csv_text, decimal};
use crate::panel::Panel;
use crate::picture::Picture;
use crate::sizes::{HEAD_TEXT, LABEL_BASELINE};
use crate::svg::{Anchor, Area, Svg, TextStyle};
use ndarray::ArrayView2;

/// One quantity, measured and expected in the same cells, as arrays [x, y] with both axes
/// ascending. A cell without a value is NaN.
#[derive(Clone, Debug)]
pub struct Comparison<'a> {
    /// The title, as markup, which names the quantity and the plane.
    pub title: &'a str,
    /// A line below the title, such as the verdict, as markup; may be empty.
    pub note: &'a str,
    /// The axis of the arrays' first index.
    pub x: Axis,
    /// The axis of the arrays' second index.
    pub y: Axis,
    /// The quantity whose values the cells show.
    pub quantity: AxisQuantity,
    /// The color scale of the measured and the predicted values.
    pub scale: Scale,
    /// The names of the two sources, such as "measured" and "predicted".
    pub sides: [&'a str; 2],
    /// Measured values, which may be negative after subtraction of the shot noise.
    pub measured: ArrayView2<'a, f64>,
    /// Predicted values, or other values with which the measured values are compared.
    pub predicted: ArrayView2<'a, f64>,
    /// The difference (measured − predicted) / σ.
    pub z: ArrayView2<'a, f64>,
    /// Measured and predicted values in finer cells over the same axes. The picture shows the
    /// values in finer cells, and the table has the original values.
    pub finer: Option<[ArrayView2<'a, f64>; 2]>,
}

/// The number of σ beyond which the colors of differences saturate.
const Z_LIMIT: f64 = 4.0;
/// Side length of a panel.
const PANEL: f64 = 240.0;
/// Left edges of the three panels and of the two color bars. The first two panels share a color
/// bar.
const PANELS_X: [f64; 3] = [66.0, 66.0 + PANEL + 18.0, 66.0 + 2.0 * PANEL + 118.0];
const BARS_X: [f64; 2] = [PANELS_X[1] + PANEL + 10.0, PANELS_X[2] + PANEL + 10.0];
/// The label of a color bar may be longer than the bar by this length.
const OVERHANG: f64 = 12.0;
const WIDTH: f64 = BARS_X[1] + bar::WIDTH + 52.0;

/// Draws a comparison. Measured and predicted values share a color scale, and their difference has
/// a scale of ±4 σ.
///
/// In decibels, the reference is the largest predicted value. The CSV has a row for each cell.
///
/// # Errors
/// If a heat map or the numbers cannot be written.
///
/// # Panics
/// If the three arrays differ in shape.
pub fn comparison(comparison: &Comparison<'_>) -> Result<Figure, Error> {
    let shape = comparison.measured.dim();
    assert_eq!(comparison.predicted.dim(), shape, "shape of predicted");
    assert_eq!(comparison.z.dim(), shape, "shape of z");
    let mut svg = Svg::default();
    let top = svg.title(
        PANELS_X[0],
        WIDTH - PANELS_X[0] - 10.0,
        comparison.title,
        comparison.note,
    ) + 24.0;
    draw_panels(&mut svg, comparison, top)?;
    let baseline = top + PANEL + LABEL_BASELINE;
    if [comparison.measured, comparison.predicted, comparison.z].map(has_gaps) != [false; 3] {
        bar::gap_key(&mut svg, WIDTH - 12.0, baseline);
    }
    let svg = svg.finish(WIDTH, baseline + 13.0);
    Ok(Figure::new(svg, numbers(comparison)?))
}

fn draw_panels(svg: &mut Svg, comparison: &Comparison<'_>, top: f64) -> Result<(), Error> {
    let value = value_shading(comparison);
    let [one, other] = comparison.sides;
    let axis = Axis::edges(&comparison.difference("*σ*"), "", [-Z_LIMIT, Z_LIMIT]);
    let difference = Shading::linear(Colors::Diverging, axis).showing(comparison.z);
    let [measured, predicted] = comparison.drawn();
    let panels = [
        (one, measured, &value),
        (other, predicted, &value),
        ("difference", comparison.z, &difference),
    ];
    for (index, (name, values, shading)) in panels.into_iter().enumerate() {
        let panel = Panel {
            label_y: index == 0,
            ..Panel::new(area(index, top), &comparison.x, &comparison.y)
        };
        panel.heat_map(svg, values, shading)?;
        panel.axes(svg);
        let at = [panel.area.middle()[0], top - 9.0];
        svg.text(TextStyle::new(at, HEAD_TEXT, Anchor::Middle).bold(), name);
    }
    bar::draw(svg, &value, BARS_X[0], area(1, top), OVERHANG)?;
    bar::draw(svg, &difference, BARS_X[1], area(2, top), OVERHANG)
}

impl<'a> Comparison<'a> {
    /// The values of both sources that are drawn.
    fn drawn(&self) -> [ArrayView2<'a, f64>; 2] {
        self.finer.unwrap_or([self.measured, self.predicted])
    }

    /// The name of the difference between the two sources, divided by its standard
    /// deviation.
    fn difference(&self, sigma: &str) -> String {
        let [one, other] = self.sides;
        format!("({one} − {other}) / {sigma}")
    }
}

fn area(index: usize, top: f64) -> Area {
    Area::new([PANELS_X[index], top], [PANEL, PANEL])
}

/// The colors that the measured and the predicted values share.
fn value_shading(comparison: &Comparison<'_>) -> Shading {
    let Comparison {
        quantity, scale, ..
    } = comparison;
    let [measured, predicted] = comparison.drawn();
    let of_peak = match comparison.sides {
        [_, "predicted"] => "the predicted peak".to_owned(),
        [_, other] => format!("the peak of {other}"),
    };
    let decibels = format!("{} relative to {of_peak}", quantity.name);
    let peak = match scale {
        Scale::Decibel { .. } => largest(predicted),
        _ => largest(measured).max(largest(predicted)),
    };
    let shading = scale.shading(Colors::MAGNITUDES, quantity, peak, &decibels);
    shading.showing(measured).showing(predicted)
}

/// The table of a comparison, with a row for each cell and with x varying slowest.
fn numbers(comparison: &Comparison<'_>) -> Result<String, Error> {
    let Comparison { x, y, quantity, .. } = comparison;
    let of = |side: usize| format!("{} {}", comparison.sides[side], quantity.heading());
    let header = [
        x.quantity.heading(),
        y.quantity.heading(),
        of(0),
        of(1),
        comparison.difference("σ"),
    ];
    let measured = Picture::new([x.clone(), y.clone()], comparison.measured);
    let others = comparison.predicted.iter().zip(comparison.z);
    let lines = measured.cells().into_iter().zip(others);
    let lines = lines.map(|(cell, (predicted, z))| {
        let others = [predicted, z].map(decimal);
        cell.into_iter().chain(others).collect()
    });
    csv_text(&header, lines)
}
