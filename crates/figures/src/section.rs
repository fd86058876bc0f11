//! The scene cut along the central ray.

use crate::cut::Cut;
use crate::figure::{Error, Figure, csv_text, decimal};
use crate::svg::{Area, Svg};
use crate::text::plain;
use crate::world::World;
use etendue_field::Side;

/// What a line of the cut is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SegmentKind {
    /// Emits.
    Light,
    /// Stops light and scatters none.
    Blocker,
    /// Receives, and reflects; it has a dark side.
    Surface,
    /// Lets light through.
    Glass,
    /// Shines from far away, wherever it is drawn.
    Sky,
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

/// The plane of z, the distance along the central ray, and x, or y, all in metres.
///
/// Not to scale: z fills the width. What sticks out is cut off.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// The coordinate across, markup.
    pub across: String,
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
    /// The cut through y, where it shows something else; drawn above.
    pub other: Option<Box<Self>>,
    /// The scene to scale; drawn above all.
    pub world: Option<World>,
}

impl Section {
    /// Draws the scene to scale and the other cut; returns where the cut itself is to go.
    pub(crate) fn draw_above(&self, svg: &mut Svg, [x, y]: [f64; 2], size: [f64; 2]) -> Area {
        let [width, height] = size;
        let mut top = y;
        if let Some(world) = &self.world {
            world.draw(svg, [x, top], width);
            top += World::HEIGHT;
        }
        if let Some(other) = &self.other {
            let area = Area {
                x,
                y: top + Cut::AXIS,
                width,
                height: OTHER,
            };
            Cut::new(other, area).draw(svg);
            top = area.bottom();
        }
        Area {
            x,
            y: top + Cut::AXIS,
            width,
            height,
        }
    }
}

/// Height of the cut through y.
const OTHER: f64 = 150.0;

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
    let area = section.draw_above(&mut svg, [LEFT, top], [inner, HEIGHT]);
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
    for cut in std::iter::once(section).chain(section.other.as_deref()) {
        for segment in &cut.segments {
            let kind = match segment.kind {
                SegmentKind::Light => "light",
                SegmentKind::Blocker => "blocker",
                SegmentKind::Surface => "surface",
                SegmentKind::Glass => "glass",
                SegmentKind::Sky => "sky",
            };
            let kind = match plain(&cut.across).as_str() {
                "x" => kind.to_owned(),
                other => format!("{kind} over {other}"),
            };
            let name = segment.label.as_deref().unwrap_or_default();
            row(&kind, name, &[segment.start, segment.end].concat());
        }
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
