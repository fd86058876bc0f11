//! The scene cut along the central ray.

use crate::cut::Cut;
use crate::figure::{Error, Figure, csv_text, decimal};
use crate::svg::{Area, Svg};
use etendue_field::Side;

/// What a line of the cut is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SegmentKind {
    /// Emits.
    Light,
    /// Stops light and scatters none.
    Blocker,
    /// Receives and reflects.
    Surface,
}

/// A straight piece of something the cut passes through; points are (z, x), metres. An infinite x goes on beyond the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// What it is.
    pub kind: SegmentKind,
    /// One end (z, x).
    pub start: [f64; 2],
    /// The other end.
    pub end: [f64; 2],
    /// Its name; one piece of several is enough to carry it.
    pub label: Option<String>,
}

/// A virtual plane on the central ray.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaneMark {
    /// Its name.
    pub name: String,
    /// Distance from the light along the central ray, metres.
    pub distance: f64,
    /// On which side of what stands there; drawn a little to that side.
    pub side: Side,
}

/// The plane of z, the distance along the central ray, and x, both in metres.
///
/// Not to scale: z fills the width. What sticks out is cut off.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Length of the central ray, metres.
    pub length: f64,
    /// Whether the central ray has turned on the way.
    pub unfolded: bool,
    /// Largest x shown, metres.
    pub half_width: f64,
    /// Lights, blockers and surfaces.
    pub segments: Vec<Segment>,
    /// The virtual planes, in the order of their numbers.
    pub planes: Vec<PlaneMark>,
    /// Outlines (z, x) of bodies, filled; segments draw their edges.
    pub bodies: Vec<Vec<[f64; 2]>>,
}

/// Draws the cut alone, with the names of its planes.
///
/// The CSV has a row for each segment, plane and corner of a body.
///
/// # Errors
/// When the numbers cannot be written.
pub fn section(section: &Section, title: &str, note: &str) -> Result<Figure, Error> {
    // Wide enough for the names of the planes side by side.
    let inner = (120.0 * section.planes.len() as f64).max(640.0);
    let mut svg = Svg::default();
    let top = svg.title(LEFT, inner, title, note);
    let area = Area {
        x: LEFT,
        y: top + Cut::AXIS,
        width: inner,
        height: HEIGHT,
    };
    let cut = Cut::new(section, area);
    cut.draw(&mut svg);
    let pitch = inner / section.planes.len().max(1) as f64;
    let heads = area.bottom() + LEADERS;
    for plane in 0..section.planes.len() {
        let middle = area.x + pitch * (plane as f64 + 0.5);
        cut.leader(&mut svg, plane, [middle, heads]);
        cut.heading(&mut svg, plane, [middle, heads], pitch - 10.0);
    }
    let bottom = if section.planes.is_empty() {
        area.bottom() + 10.0
    } else {
        heads + Cut::HEADING
    };
    Ok(Figure {
        svg: svg.finish(area.right() + 20.0, bottom),
        csv: numbers(section)?,
    })
}

const LEFT: f64 = 66.0;
const HEIGHT: f64 = 260.0;
/// Height of the lines from the planes to their names.
const LEADERS: f64 = 34.0;

fn numbers(section: &Section) -> Result<String, Error> {
    let header = ["kind", "name", "z0 [m]", "x0 [m]", "z1 [m]", "x1 [m]"].map(str::to_owned);
    let mut rows = Vec::new();
    let mut row = |kind: &str, name: &str, points: &[f64]| {
        let mut cells = vec![kind.to_owned(), name.to_owned()];
        cells.extend(points.iter().map(decimal));
        cells.resize(header.len(), String::new());
        rows.push(cells);
    };
    row("central ray", "", &[0.0, 0.0, section.length, 0.0]);
    for segment in &section.segments {
        let kind = match segment.kind {
            SegmentKind::Light => "light",
            SegmentKind::Blocker => "blocker",
            SegmentKind::Surface => "surface",
        };
        let name = segment.label.as_deref().unwrap_or_default();
        row(kind, name, &[segment.start, segment.end].concat());
    }
    for plane in &section.planes {
        row("plane", &plane.name, &[plane.distance]);
    }
    for (number, body) in section.bodies.iter().enumerate() {
        for corner in body {
            row("body", &(number + 1).to_string(), corner);
        }
    }
    csv_text(&header, rows)
}
