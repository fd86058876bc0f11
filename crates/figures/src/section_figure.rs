//! Draws the scene cut along the central ray, with the names of its planes.

use crate::cut::SectionLayout;
use crate::figure::{Error, Figure, csv_text, decimal};
use crate::section::{DrawnWorld, Section, SegmentKind};
use crate::svg::{Area, Svg};
use crate::text::plain;

impl Section {
    /// The z of the first light, or 0 if no light is behind the start of the central ray.
    pub(crate) fn first_light(&self) -> f64 {
        let lights = self
            .segments
            .iter()
            .filter(|s| s.kind == SegmentKind::Light);
        lights.map(|light| light.start[0]).fold(0.0, f64::min)
    }

    /// Draws the scene to scale and, if `all`, the cut through y; returns the area for the main cut.
    /// The heights of drawings are multiplied by `scale`.
    pub(crate) fn draw_above(
        &self,
        svg: &mut Svg,
        [x, y]: [f64; 2],
        [width, height]: [f64; 2],
        (all, scale): (bool, f64),
    ) -> Area {
        let mut top = y;
        if let Some(world) = &self.world {
            top = world.draw(svg, [x, top], [width, scale * DrawnWorld::HEIGHT]);
        }
        if let Some(other) = self.other.as_ref().filter(|_| all) {
            let area = Area::new([x, top + SectionLayout::AXIS], [width, scale * OTHER]);
            let cut = SectionLayout::new(other, area);
            cut.draw(svg);
            top = cut.bottom();
        }
        Area::new([x, top + SectionLayout::AXIS], [width, scale * height])
    }
}

/// Height of the cut through y.
const OTHER: f64 = 150.0;

/// Draws the cut without pictures below it, with the names of the planes.
///
/// The CSV has a row for each segment, plane and corner of a body.
///
/// # Errors
/// If the numbers cannot be written.
pub fn section(section: &Section, title: &str, note: &str) -> Result<Figure, Error> {
    // A width of 120 units per plane suffices for the names of the planes side by side.
    let inner = (120.0 * section.planes.len() as f64).max(640.0);
    let mut svg = Svg::default();
    let top = svg.title(LEFT, inner, title, note);
    let area = section.draw_above(&mut svg, [LEFT, top], [inner, HEIGHT], (true, 1.0));
    let cut = SectionLayout::new(section, area);
    cut.draw(&mut svg);
    let pitch = inner / section.planes.len().max(1) as f64;
    let heads = cut.bottom() + LEADERS;
    let middle = |plane: usize| area.x + pitch * (plane as f64 + 0.5);
    for plane in 0..section.planes.len() {
        cut.leader(&mut svg, plane, [middle(plane), heads]);
    }
    let columns = (0..section.planes.len()).map(|plane| (plane, middle(plane), pitch - 10.0));
    cut.headings(&mut svg, heads, columns);
    let bottom = if section.planes.is_empty() {
        cut.bottom() + 10.0
    } else {
        let rooms = (0..section.planes.len()).map(|plane| (plane, pitch - 10.0));
        heads + cut.heading_height(rooms)
    };
    let svg = svg.finish(area.right() + 20.0, bottom);
    Ok(Figure::new(svg, numbers(section)?))
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
