//! Draws curves and measured points in adjacent panels.

use crate::axis::{Axis, AxisQuantity, upright_ticks};
use crate::figure::{Error, Figure, csv_text, decimal};
use crate::grid::LEFT;
use crate::panel::Panel;
use crate::sizes::{FAINT, HEAD_TEXT, INK, LABEL_BASELINE, LABEL_TEXT, THEORY_COLOR, TICK_TEXT};
use crate::style::Style;
use crate::svg::{Anchor, Area, Stroke, Svg, TextStyle};
use crate::text::{plain, width};
use etendue_field::whole;

/// The kind of a curve, which determines its style.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveKind {
    /// A solid line.
    Theory,
    /// A dashed line.
    Rival,
    /// Measured points with error bars.
    Measured,
    /// A line of another colour with small gaps, for a second theory.
    OtherTheory,
    /// A dotted line of another colour, for a third theory.
    ThirdTheory,
    /// Large open points with error bars, for a second measurement.
    OtherMeasured,
    /// Thick bars below points, for the errors of their changes.
    Change,
}

impl CurveKind {
    /// The stroke of a line, or `None` for points.
    fn stroke(self) -> Option<Stroke> {
        match self {
            Self::Theory => Some(THEORY),
            Self::Rival => Some(RIVAL),
            Self::OtherTheory => Some(OTHER_THEORY),
            Self::ThirdTheory => Some(THIRD_THEORY),
            Self::Measured | Self::OtherMeasured | Self::Change => None,
        }
    }

    /// The layer in which a curve is drawn: points over lines, and small over large points.
    fn layer(self) -> usize {
        match self {
            Self::Theory | Self::Rival | Self::OtherTheory | Self::ThirdTheory => 0,
            Self::OtherMeasured | Self::Change => 1,
            Self::Measured => 2,
        }
    }
}

/// A curve, or a set of points.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The kind of the curve, which determines its style.
    pub kind: CurveKind,
    /// The name in the key; curves with the same name share an entry.
    pub name: String,
    /// The points (x, y, standard error of y), in the order in which they are joined; the
    /// standard error is 0 on a line.
    pub points: Vec<[f64; 3]>,
}

impl Curve {
    /// Creates a curve of the given kind and name through points.
    #[must_use]
    pub fn new(kind: CurveKind, name: &str, points: Vec<[f64; 3]>) -> Self {
        Self {
            kind,
            name: name.to_owned(),
            points,
        }
    }
}

/// A panel of curves in one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct CurvePanel {
    /// Title above the frame, as markup.
    pub title: String,
    /// The quantity along x.
    pub x: AxisQuantity,
    /// The curves in the frame.
    pub curves: Vec<Curve>,
    /// Whether x and y are logarithmic. On a logarithmic axis, points with values of 0 or less
    /// are left out.
    pub is_log: [bool; 2],
}

impl CurvePanel {
    /// A panel whose axes are not logarithmic.
    #[must_use]
    pub fn new(title: &str, x: AxisQuantity, curves: Vec<Curve>) -> Self {
        Self {
            title: title.to_owned(),
            x,
            curves,
            is_log: [false; 2],
        }
    }
}

/// Panels of curves that show one quantity. Each panel has its own scales. They include y = 0,
/// except if y is logarithmic or all values are far from 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Curves {
    /// Title, markup.
    pub title: String,
    /// A line below the title, as markup.
    pub note: String,
    /// The quantity along y.
    pub y: AxisQuantity,
    /// The panels, row by row from the top; each row runs from left to right.
    pub panels: Vec<CurvePanel>,
}

const ACROSS: usize = 3;
const RIGHT: f64 = 20.0;
/// Minimum width of the text above the panels.
const TITLE: f64 = 440.0;
/// Height of a panel.
const HEIGHT: f64 = 136.0;
/// Maximum width of a panel.
const WIDEST: f64 = 262.0;
/// Minimum width of a panel that has other panels beside it.
const NARROWEST: f64 = 100.0;
const BETWEEN: [f64; 2] = [58.0, 74.0];
/// Width that is reserved for tick texts beside an axis.
const USUAL: f64 = 28.0;
const RADIUS: f64 = 3.0;
/// Half of the length of the stroke at the end of an error bar.
const CAP: f64 = 3.0;
const THEORY: Stroke = Stroke::solid(THEORY_COLOR, 1.8);
const RIVAL: Stroke = Stroke {
    color: "#c8502e",
    width: 1.6,
    dash: "6 4",
};
/// The gaps show a line of theory below.
const OTHER_THEORY: Stroke = Stroke {
    color: "#3b8f5a",
    width: 1.8,
    dash: "10 4",
};
const THIRD_THEORY: Stroke = Stroke {
    color: "#7b4fa3",
    width: 2.0,
    dash: "2 3",
};
/// A bar that is wider than a point, so that a short bar is seen beside it.
const CHANGE: Stroke = Stroke::solid("#c8502e", 9.0);
const POINT: &str = INK;
/// Radius of an open point and of its hole, in which another point is visible.
const OPEN: f64 = 5.0;
const HOLE: f64 = 3.8;
const PAPER: &str = "#ffffff";
/// Half the length of the dash that stands for a curve of a single point.
const DASH: f64 = 11.0;
/// Length of the short line that the key shows for each curve.
const SAMPLE: f64 = 30.0;

/// Draws the panels. The CSV has a row for each point.
///
/// # Errors
/// If the numbers cannot be written.
pub fn curves(curves: &Curves, style: &Style) -> Result<Figure, Error> {
    // Long numbers beside an axis shift the label of the axis outwards.
    let ticks = curves.panels.iter().flat_map(|panel| {
        let [_, y] = axes(panel, &curves.y);
        upright_ticks(&y, style.scale * HEIGHT)
    });
    let widest = ticks
        .map(|tick| width(&tick.text, TICK_TEXT))
        .fold(0.0, f64::max);
    let more = (widest - USUAL).max(0.0);
    let (left, between) = (LEFT + more, BETWEEN[0] + more);
    let page = style.page() - left - RIGHT;
    let across = whole((page + between) / (NARROWEST + between));
    let columns = curves.panels.len().clamp(1, across.clamp(1, ACROSS));
    let room = page - (columns - 1) as f64 * between;
    let size = (room / columns as f64).floor().min(WIDEST);
    let inner = columns as f64 * (size + between) - between;
    let height = style.scale * HEIGHT;
    let mut svg = Svg::default();
    let inner = inner.max(TITLE.min(page));
    let top = style.title(&mut svg, left, inner, &curves.title, &curves.note);
    let all = curves.panels.iter().flat_map(|panel| &panel.curves);
    let top = key(&mut svg, all, [left, top + 16.0], inner) + 42.0;
    let mut bottom = top;
    let head = TextStyle::new([0.0; 2], HEAD_TEXT, Anchor::Start).bold();
    let head = head.fitting(curves.panels.iter().map(|panel| (&*panel.title, size)));
    for (i, panel) in curves.panels.iter().enumerate() {
        let [column, row] = [i % columns, i / columns].map(|n| n as f64);
        let x = left + column * (size + between);
        let y = top + row * (height + BETWEEN[1]);
        let area = Area::new([x, y], [size, height]);
        draw(&mut svg, panel, &curves.y, area);
        svg.fitted(head.at([x, y - 8.0]), &panel.title, size);
        bottom = area.bottom();
    }
    let svg = svg.finish(left + inner + RIGHT, bottom + LABEL_BASELINE + 14.0);
    Ok(Figure::new(svg, numbers(curves)?))
}

/// Draws the key, which shows each name once with its style, on as many lines as needed. Returns
/// the last baseline.
pub(crate) fn key<'a>(
    svg: &mut Svg,
    curves: impl Iterator<Item = &'a Curve>,
    [left, mut y]: [f64; 2],
    room: f64,
) -> f64 {
    let mut x = left;
    let mut known: Vec<&str> = Vec::new();
    for curve in curves {
        if known.contains(&curve.name.as_str()) {
            continue;
        }
        known.push(&curve.name);
        let long = SAMPLE + 8.0 + width(&plain(&curve.name), LABEL_TEXT);
        if x > left && x + long > left + room {
            [x, y] = [left, y + 18.0];
        }
        let middle = y - 4.0;
        if let Some(stroke) = curve.kind.stroke() {
            svg.line([x, middle], [x + SAMPLE, middle], stroke);
        } else {
            let at = [x + 0.5 * SAMPLE, middle];
            point(svg, curve.kind, at, [middle - 7.0, middle + 7.0]);
        }
        let start = x + SAMPLE + 8.0;
        svg.markup(
            TextStyle::new([start, y], LABEL_TEXT, Anchor::Start),
            &curve.name,
        );
        x += long + 30.0;
    }
    y
}

/// Checks whether a point can be drawn.
fn is_drawn(panel: &CurvePanel, point: &[f64; 3]) -> bool {
    [0, 1].iter().all(|i| !panel.is_log[*i] || point[*i] > 0.0)
}

/// The axes of a panel, which cover all its points and y = 0.
fn axes(panel: &CurvePanel, y: &AxisQuantity) -> [Axis; 2] {
    let points = || {
        let all = panel.curves.iter().flat_map(|c| &c.points);
        all.filter(|point| is_drawn(panel, point))
    };
    let around = |low: fn(&[f64; 3]) -> f64, high: fn(&[f64; 3]) -> f64| {
        let from = points().map(low).fold(f64::INFINITY, f64::min);
        [from, points().map(high).fold(f64::NEG_INFINITY, f64::max)]
    };
    let axis = |quantity, is_log, ends| Axis {
        is_log,
        ..Axis::of(quantity, ends)
    };
    let by_factors = |[low, high]: [f64; 2]| {
        let margin = libm::pow(high / low, 0.06).max(1.01);
        [low / margin, high * margin]
    };
    let [low, high] = around(|p| p[0], |p| p[0]);
    let margin = 0.04 * (high - low);
    let across = if panel.is_log[0] {
        by_factors([low, high])
    } else {
        [low - margin, high + margin]
    };
    let up = if panel.is_log[1] {
        by_factors(around(|p| p[1], |p| p[1] + p[2]))
    } else {
        let [least, most] = around(|p| p[1] - p[2], |p| p[1] + p[2]);
        // If all values are far from zero, they would look like a flat line on an axis that
        // includes zero.
        let is_far = most - least < 0.3 * least.abs().max(most.abs());
        let [least, most] = if is_far {
            [least, most]
        } else {
            [least.min(0.0), most.max(0.0)]
        };
        let margin = 0.06 * (most - least);
        // If no value is negative, the axis begins at zero.
        [
            if least == 0.0 { 0.0 } else { least - margin },
            most + margin,
        ]
    };
    [
        axis(&panel.x, panel.is_log[0], across),
        axis(y, panel.is_log[1], up),
    ]
}

fn draw(svg: &mut Svg, panel: &CurvePanel, y: &AxisQuantity, area: Area) {
    let [x, y] = axes(panel, y);
    let frame = Panel::new(area, &x, &y);
    svg.clipped(area, |svg| {
        for curve in layered(&panel.curves) {
            let points = curve.points.iter().filter(|p| is_drawn(panel, p));
            draw_curve(svg, &frame, curve.kind, &points.collect::<Vec<_>>());
        }
    });
    frame.axes(svg);
}

/// Returns curves in the order in which they are drawn.
pub(crate) fn layered(curves: &[Curve]) -> Vec<&Curve> {
    let mut curves: Vec<&Curve> = curves.iter().collect();
    curves.sort_by_key(|curve| curve.kind.layer());
    curves
}

/// Draws a line or points in a frame. A line through one point is a short stroke.
pub(crate) fn draw_curve(svg: &mut Svg, frame: &Panel<'_>, kind: CurveKind, points: &[&[f64; 3]]) {
    let at: Vec<[f64; 2]> = points.iter().map(|p| frame.point(p[0], p[1])).collect();
    match (kind.stroke(), at.as_slice()) {
        (Some(stroke), [[x, y]]) => svg.line([x - DASH, *y], [x + DASH, *y], stroke),
        (Some(stroke), at) => svg.polyline(at, stroke),
        (None, _) => {
            for (p, at) in points.iter().zip(at) {
                // If the standard error is as large as the value, the error bar extends below the
                // frame.
                let ends = [(p[1] - p[2]).max(frame.y.min), p[1] + p[2]];
                let ends = ends.map(|y| frame.point(p[0], y)[1]);
                point(svg, kind, at, ends);
            }
        }
    }
}

/// Draws a point with its error bar.
fn point(svg: &mut Svg, kind: CurveKind, at: [f64; 2], ends: [f64; 2]) {
    if kind == CurveKind::Change {
        let [from, to] = ends.map(|y| [at[0], y]);
        svg.line(from, to, CHANGE);
        return;
    }
    bar(svg, at, ends);
    if kind == CurveKind::OtherMeasured {
        svg.circle(at, OPEN, POINT);
        svg.circle(at, HOLE, PAPER);
    } else {
        svg.circle(at, RADIUS, POINT);
    }
}

/// An error bar.
fn bar(svg: &mut Svg, [x, _]: [f64; 2], [low, high]: [f64; 2]) {
    let stroke = Stroke::solid(FAINT, 1.2);
    svg.line([x, low], [x, high], stroke);
    for end in [low, high] {
        svg.line([x - CAP, end], [x + CAP, end], stroke);
    }
}

/// The CSV of the panels, with a row for each point.
fn numbers(curves: &Curves) -> Result<String, Error> {
    let y = curves.y.heading();
    let header = ["panel", "axis", "curve", "x", &y, "standard error"].map(str::to_owned);
    let rows = curves.panels.iter().flat_map(|panel| {
        panel.curves.iter().flat_map(|curve| {
            curve.points.iter().map(|[x, y, error]| {
                vec![
                    plain(&panel.title),
                    panel.x.heading(),
                    plain(&curve.name),
                    decimal(x),
                    decimal(y),
                    decimal(error),
                ]
            })
        })
    });
    csv_text(&header, rows)
}
