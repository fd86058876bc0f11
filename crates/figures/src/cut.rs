//! Draws a [`Section`] into any area of a figure, such as the upper part of a strip.

mod place;

use crate::axis::Axis;
use crate::marks::{BADGE, HATCH, Hatching, LIGHT, PLANE, arrow, badge, line_of};
use crate::panel::Panel;
use crate::section::{PlaneMark, Section, Segment, SegmentKind};
use crate::sizes::{FAINT, HEAD_TEXT, INK, LABEL_TEXT, LEAST_TEXT, SOFT, TICK, TICK_TEXT};
use crate::svg::{Anchor, Area, Stroke, Svg, TextStyle};
use crate::text::{lines, plain, width};
use etendue_field::Side;
use place::{SegmentName, names, number_places};

const BODY: &str = "#b9b9b9";

/// Width of the space to the left and to the right of the ends of the central ray.
const MARGIN: f64 = 36.0;
/// Height of the lines that lead from planes to their numbers.
const FEET: f64 = 10.0;
/// Minimum height of the plot.
const MIN_PLOT: f64 = 60.0;
/// Height of a row of segment names.
const NAME_ROW: f64 = 17.0;

/// Line spacing of a plane's heading.
const HEADING_LINE: f64 = 16.0;

/// The name of a plane in one line, or in two lines if it is too long.
fn name_lines(name: &str, room: f64) -> Vec<String> {
    // Bold letters are wider than the estimate for regular letters, so less width is assumed to
    // be available.
    let mut words = lines(name, 1.2 * SMALL_NAME, room).into_iter();
    let first = words.next().unwrap_or_default();
    if first.chars().count() <= NUMBER {
        return vec![name.to_owned()];
    }
    let rest: Vec<String> = words.collect();
    let rest = (!rest.is_empty()).then(|| rest.join(" "));
    std::iter::once(first).chain(rest).collect()
}

/// Number of characters that a plane's number takes before the plane's name on the same line.
const NUMBER: usize = 2;
/// Minimum font size of a plane's name on one line.
const SMALL_NAME: f64 = 10.0;

/// A section laid out in an area of the drawing.
#[derive(Debug)]
pub(crate) struct SectionLayout<'a> {
    section: &'a Section,
    area: Area,
    /// The area that shows the range of x. Names are above this area, and plane numbers are below
    /// it.
    plot: Area,
    z: Axis,
    x: Axis,
    names: Vec<SegmentName>,
    /// Horizontal position of each plane's number.
    planes: Vec<f64>,
}

impl<'a> SectionLayout<'a> {
    /// Height of the ticks and the label of the z axis, above the plot.
    pub(crate) const AXIS: f64 = 46.0;
    /// Height of a plane's heading, which consists of the number, the name on one line, and the
    /// distance.
    const HEADING: f64 = 56.0;

    pub(crate) fn new(section: &'a Section, area: Area) -> Self {
        let along = if section.unfolded {
            "distance along the unfolded central ray *z*"
        } else {
            "distance along the central ray *z*"
        };
        let z = Axis::edges(along, "m", [section.first_light(), section.length]);
        let across =
            |distance: f64| area.x + MARGIN + z.fraction(distance) * (area.width - 2.0 * MARGIN);
        let names = names(&section.segments, area, across);
        let rows = names.iter().map(|name| name.row + 1).max().unwrap_or(0);
        let head = NAME_ROW * rows as f64 + 6.0;
        let foot = 2.0 * BADGE + 4.0 + FEET;
        let plot = Area {
            y: area.y + head,
            height: (area.height - head - foot).max(MIN_PLOT),
            ..area
        };
        let area = Area {
            height: head + plot.height + foot,
            ..area
        };
        Self {
            planes: number_places(section, across),
            x: Axis::edges(
                &section.across,
                "m",
                [-section.half_width, section.half_width],
            ),
            section,
            area,
            plot,
            z,
            names,
        }
    }

    /// The lower edge of the cut, which is higher than the given area if there are many rows of
    /// names.
    pub(crate) fn bottom(&self) -> f64 {
        self.area.bottom()
    }

    /// Draws the complete cut, with axes and plane numbers.
    pub(crate) fn draw(&self, svg: &mut Svg) {
        svg.clipped(self.plot, |svg| {
            for body in &self.section.bodies {
                let corners: Vec<_> = body.iter().map(|corner| self.point(*corner)).collect();
                svg.polygon(&corners, BODY);
            }
            self.segments(svg, SegmentKind::Surface);
            self.segments(svg, SegmentKind::Glass);
        });
        for plane in 0..self.planes.len() {
            self.plane(svg, plane);
        }
        self.central_ray(svg);
        svg.clipped(self.plot, |svg| {
            self.segments(svg, SegmentKind::Blocker);
            self.segments(svg, SegmentKind::Light);
        });
        self.sky(svg);
        for name in &self.names {
            let y = self.area.y + NAME_ROW * (name.row as f64 + 1.0) - 2.0;
            svg.text(
                TextStyle::new([name.middle, y], TICK_TEXT, Anchor::Middle),
                &name.text,
            );
        }
        self.z_axis(svg);
        self.x_axis(svg);
    }

    /// Draws a thin line from a plane's number to the top of the plane's heading.
    pub(crate) fn leader(&self, svg: &mut Svg, plane: usize, [x, y]: [f64; 2]) {
        let Some(place) = self.planes.get(plane) else {
            return;
        };
        let start = self.area.bottom() - 2.0;
        let stroke = Stroke::solid(FAINT, 0.8);
        let points = [[*place, start], [*place, start + 8.0], [x, y - 8.0], [x, y]];
        svg.polyline(&points, stroke);
    }

    /// The height of the headings of some planes, given the width that is available for
    /// each heading.
    pub(crate) fn heading_height(&self, rooms: impl Iterator<Item = (usize, f64)>) -> f64 {
        let more = rooms.filter_map(|(plane, room)| {
            let mark = self.section.planes.get(plane)?;
            let lines = name_lines(&mark.name, room).len() + self.place(mark, room).len();
            Some(lines.saturating_sub(2))
        });
        Self::HEADING + HEADING_LINE * more.max().unwrap_or(0) as f64
    }

    /// The distance of a plane as text on one or two lines. If an element is at the same
    /// distance as the plane, the text also states the side on which the plane is.
    fn place(&self, mark: &PlaneMark, room: f64) -> Vec<String> {
        // The distance is written with four significant digits, in the shortest form.
        let rounded = format!("{:.3e}", mark.distance).parse::<f64>();
        let distance = rounded.unwrap_or(mark.distance);
        let distance = format!("*z* = {} m", crate::axis::minus(&distance.to_string()));
        let text = match self.beside(mark) {
            "" => distance.clone(),
            side => format!("{distance}, {side}"),
        };
        if width(&plain(&text), LEAST_TEXT) <= room {
            vec![text]
        } else {
            let side = self.beside(mark).to_owned();
            let lines = [distance, side].into_iter();
            lines.filter(|line| !line.is_empty()).collect()
        }
    }

    /// Draws the number, the name and the distance of planes, each centred below a point at the
    /// height `y`. The planes have a number, a horizontal position and a room.
    pub(crate) fn headings(
        &self,
        svg: &mut Svg,
        y: f64,
        planes: impl Iterator<Item = (usize, f64, f64)>,
    ) {
        let each = planes.filter_map(|(plane, x, room)| {
            let mark = self.section.planes.get(plane)?;
            let texts = [name_lines(&mark.name, room), self.place(mark, room)];
            Some((plane, x, room, texts))
        });
        let each: Vec<_> = each.collect();
        let texts = |kind: usize| {
            let all = each.iter().flat_map(move |(_, _, room, texts)| {
                texts[kind].iter().map(|text| (text.as_str(), *room))
            });
            all.collect::<Vec<_>>()
        };
        let bold = TextStyle::new([0.0; 2], HEAD_TEXT, Anchor::Middle).bold();
        let soft = TextStyle::new([0.0; 2], TICK_TEXT, Anchor::Middle).fill(SOFT);
        let styles =
            [(bold, 0), (soft, 1)].map(|(style, kind)| style.fitting(texts(kind).into_iter()));
        for (plane, x, room, texts) in &each {
            badge(svg, [*x, y + BADGE], *plane);
            let lines = texts.iter().zip(styles);
            let lines =
                lines.flat_map(|(texts, style)| texts.iter().map(move |text| (text, style)));
            for (i, (text, style)) in lines.enumerate() {
                svg.fitted(
                    style.at([*x, y + 32.0 + HEADING_LINE * i as f64]),
                    text,
                    *room,
                );
            }
        }
    }

    /// Whether a plane is before or after an element at the same distance.
    fn beside(&self, mark: &PlaneMark) -> &'static str {
        let near = 1e-9 * self.section.length;
        let stands = |s: &Segment| {
            let ([z, x], [other_z, other_x]) = (s.start, s.end);
            // The distance at which an oblique element meets the central ray.
            let rise = other_z - z;
            let met = z + if rise.abs() < near {
                0.0
            } else {
                rise * x / (x - other_x)
            };
            let is_something = !matches!(s.kind, SegmentKind::Light | SegmentKind::Sky);
            is_something && (met - mark.distance).abs() <= near
        };
        match mark.side {
            _ if !self.section.segments.iter().any(stands) => "",
            Side::Before => "before",
            Side::After => "after",
        }
    }

    /// The position in the drawing of a point (z, x); infinite elements end at the
    /// border.
    fn point(&self, [z, x]: [f64; 2]) -> [f64; 2] {
        let [low, high] = self.x.range();
        let x = if x.is_infinite() {
            x.clamp(low, high)
        } else {
            x
        };
        [
            self.area.x + MARGIN + self.z.fraction(z) * (self.area.width - 2.0 * MARGIN),
            self.plot.bottom() - self.x.fraction(x) * self.plot.height,
        ]
    }

    fn segments(&self, svg: &mut Svg, kind: SegmentKind) {
        let (color, thickness) = line_of(kind);
        let mut hatching = Hatching::default();
        for segment in self.section.segments.iter().filter(|s| s.kind == kind) {
            let (start, end) = (self.point(segment.start), self.point(segment.end));
            // The edges of a filled body have no dark side, so they are not hatched.
            let bits = |point: &[f64; 2]| point.map(f64::to_bits);
            let mut edges = self.section.bodies.iter().flatten();
            let is_flat = edges.all(|edge| bits(edge) != bits(&segment.start));
            if kind == SegmentKind::Surface && is_flat {
                let ends = self.visible(start, end);
                hatching.draw(svg, ends, [1.0, 0.0]);
            }
            let stroke = Stroke::solid(color, thickness);
            svg.line(start, end, stroke);
            for x in [segment.start[1], segment.end[1]] {
                if x.is_infinite() {
                    self.goes_on(svg, start[0], x.signum(), color);
                }
            }
        }
    }

    /// Draws an arrow at the border, for an element that extends to infinity.
    fn goes_on(&self, svg: &mut Svg, at: f64, up: f64, color: &str) {
        let border = if up > 0.0 {
            self.plot.y
        } else {
            self.plot.bottom()
        };
        let wings = [-6.0, 6.0].map(|wing| [at + wing, border + 11.0 * up]);
        svg.polygon(&[[at, border], wings[0], wings[1]], color);
    }

    /// The part of a line that is between the height just above the plot and the height
    /// just below the plot. A horizontal line is returned unchanged.
    fn visible(&self, start: [f64; 2], end: [f64; 2]) -> [[f64; 2]; 2] {
        let rise = end[1] - start[1];
        let heights = [self.plot.y - HATCH, self.plot.bottom() + HATCH];
        let mut part = heights.map(|y| ((y - start[1]) / rise).clamp(0.0, 1.0));
        part.sort_by(f64::total_cmp);
        if part.iter().any(|t| t.is_nan()) {
            return [start, end];
        }
        part.map(|t| [0, 1].map(|i| start[i] + t * (end[i] - start[i])))
    }

    /// Draws the line of a plane at the plane's position, and the plane's number where there is
    /// space.
    fn plane(&self, svg: &mut Svg, plane: usize) {
        let [at, _] = self.point([self.section.planes[plane].distance, 0.0]);
        let stroke = Stroke {
            color: PLANE,
            width: 1.2,
            dash: "5 3",
        };
        let number = [self.planes[plane], self.area.bottom() - BADGE - 2.0];
        let [top, bottom] = [self.plot.y, self.plot.bottom()].map(|y| [at, y]);
        svg.line(top, bottom, stroke);
        let above = [number[0], number[1] - BADGE];
        svg.line(bottom, above, Stroke::solid(PLANE, 0.8));
        badge(svg, number, plane);
    }

    /// Draws distant light: an arc around the start of the path.
    fn sky(&self, svg: &mut Svg) {
        let segments = self.section.segments.iter();
        for segment in segments.filter(|s| s.kind == SegmentKind::Sky) {
            let [x, middle] = self.point([segment.start[0], 0.0]);
            let [depth, half] = [26.0, 0.5 * self.plot.height];
            let arc = (-12..=12).map(|i| {
                let t = f64::from(i) / 12.0;
                [x - depth * (1.0 - t * t), middle + t * half]
            });
            let arc: Vec<[f64; 2]> = arc.collect();
            svg.polyline(&arc, Stroke::solid(LIGHT, 4.0));
        }
    }

    fn central_ray(&self, svg: &mut Svg) {
        let [start, tip] = [0.0, self.section.length].map(|z| self.point([z, 0.0]));
        svg.line(start, [tip[0] - 6.0, tip[1]], Stroke::solid(INK, 1.3));
        arrow(svg, start, tip);
        // The name of the central ray is placed in the widest gap between planes and segments, if
        // the name fits.
        let text = "central ray";
        let marks = self.section.planes.iter();
        let mut stops: Vec<f64> = marks
            .map(|mark| self.point([mark.distance, 0.0])[0])
            .collect();
        stops.extend([start[0], tip[0]]);
        stops.extend(self.section.segments.iter().map(|s| self.point(s.start)[0]));
        stops.retain(|stop| (start[0]..=tip[0]).contains(stop));
        stops.sort_by(f64::total_cmp);
        let gaps = stops.windows(2).map(|pair| (pair[1] - pair[0], pair[0]));
        let widest = gaps.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.total_cmp(&a.1)));
        if let Some((gap, from)) = widest.filter(|(gap, _)| *gap > width(text, TICK_TEXT) + 16.0) {
            let at = [from + 0.5 * gap, start[1] - 5.0];
            svg.text(TextStyle::new(at, TICK_TEXT, Anchor::Middle), text);
        }
    }

    /// Draws the z axis at the top, because the planes' numbers and names are below the plot.
    fn z_axis(&self, svg: &mut Svg) {
        let ends = [self.section.first_light(), self.section.length];
        let [left, right] = ends.map(|z| self.point([z, 0.0])[0]);
        let y = self.area.y;
        svg.line([left, y], [right, y], Stroke::FRAME);
        for tick in self.z.ticks((right - left) / 70.0) {
            let x = self.point([tick.value, 0.0])[0];
            svg.line([x, y - TICK], [x, y], Stroke::FRAME);
            svg.text(
                TextStyle::new([x, y - TICK - 4.0], TICK_TEXT, Anchor::Middle),
                &tick.text,
            );
        }
        let style = TextStyle::new([0.5 * (left + right), y - 25.0], LABEL_TEXT, Anchor::Middle);
        svg.markup(style, &self.z.quantity.label(self.z.exponent()));
    }

    fn x_axis(&self, svg: &mut Svg) {
        let ends = [self.plot.y, self.plot.bottom()].map(|y| [self.area.x, y]);
        svg.line(ends[0], ends[1], Stroke::FRAME);
        Panel::new(self.plot, &self.z, &self.x).y_axis(svg);
    }
}
