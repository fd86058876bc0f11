//! Draws the scene to scale, as it looks along Y at the light. The drawing shows the bends of the
//! central ray and the positions of objects.

use crate::marks::{BADGE, Hatching, PLANE, arrow, badge, line_of};
use crate::section::{DrawnObject, DrawnWorld, SegmentKind};
use crate::sizes::{FAINT, INK, LABEL_TEXT, SOFT, STROKE, TICK_TEXT};
use crate::svg::{Anchor, Area, Stroke, Svg, TextStyle};
use etendue_field::tidy;

/// Height of the text above the drawing.
const HEAD: f64 = 30.0;

/// Minimum distance between a plane's number and any object.
const CLEAR: f64 = 2.0;
/// Maximum distance of a plane's number from an end of the plane.
const FARTHEST: u32 = 200;
/// The step of the angle between a plane and the line to its number.
const TURN: f64 = std::f64::consts::FRAC_PI_8;
/// A number that is further from the end of its plane is joined to it by a line.
const JOINED: f64 = BADGE + 6.0;

impl DrawnWorld {
    /// The usual height of the drawing.
    pub(crate) const HEIGHT: f64 = 170.0;

    /// Draws the scene to scale at the given upper left corner; returns its lower edge.
    pub(crate) fn draw(&self, svg: &mut Svg, [x, y]: [f64; 2], size: [f64; 2]) -> f64 {
        let area = Area::new([x, y + HEAD], size);
        let title = TextStyle::new([area.middle()[0], y + 22.0], LABEL_TEXT, Anchor::Middle);
        svg.text(title, "to scale");
        let (scale, middle) = self.scale(area);
        let [cx, cy] = area.middle();
        let place = |[z, x]: [f64; 2]| [cx + scale * (z - middle[0]), cy - scale * (x - middle[1])];
        svg.clipped(area, |svg| self.objects(svg, &place));
        let path: Vec<[f64; 2]> = self.path.iter().map(|point| place(*point)).collect();
        svg.polyline(&path, Stroke::solid(INK, 1.3));
        if let [.., from, to] = path[..] {
            arrow(svg, from, to);
        }
        for plane in &self.planes {
            let [from, to] = plane.map(place);
            svg.line(from, to, Stroke::solid(PLANE, 1.2));
        }
        let mut numbers: Vec<[f64; 2]> = Vec::new();
        for i in 0..self.planes.len() {
            let [number, end] = self.free(i, &numbers, area, &place);
            if distance(number, [end; 2]) > JOINED {
                svg.line(end, number, Stroke::solid(FAINT, STROKE));
            }
            badge(svg, number, i);
            numbers.push(number);
        }
        bar(svg, area, scale);
        area.bottom() + 16.0
    }

    /// The scale in units per metre, and the centre of the drawing. With both, the path,
    /// the planes and the lights are visible.
    fn scale(&self, area: Area) -> (f64, [f64; 2]) {
        let lights = self
            .objects
            .iter()
            .filter(|o| o.segment.kind == SegmentKind::Light);
        let lights = lights.flat_map(|light| [light.segment.start, light.segment.end]);
        let planes = self.planes.as_flattened().iter().copied();
        let points: Vec<[f64; 2]> = self
            .path
            .iter()
            .copied()
            .chain(lights)
            .chain(planes)
            .collect();
        let ends = [0, 1].map(|i| {
            let along = points.iter().map(|point| point[i]);
            [
                along.clone().fold(f64::INFINITY, f64::min),
                along.fold(f64::NEG_INFINITY, f64::max),
            ]
        });
        // The margin leaves space for plane numbers.
        let room = [area.width - 60.0, area.height - 5.0 * BADGE];
        let scales = [0, 1].map(|i| room[i] / (ends[i][1] - ends[i][0]).max(1e-9));
        (
            scales[0].min(scales[1]),
            ends.map(|[low, high]| 0.5 * (low + high)),
        )
    }

    /// A position for the number of a plane: the nearest to one of its ends, beyond the plane or
    /// beside it, that is within `area` and clear of objects, of the path, of other planes and of
    /// other numbers. Also returns this end.
    fn free(
        &self,
        plane: usize,
        taken: &[[f64; 2]],
        area: Area,
        place: &dyn Fn([f64; 2]) -> [f64; 2],
    ) -> [[f64; 2]; 2] {
        let [from, to] = self.planes[plane].map(place);
        let objects = self.objects.iter().map(|object| &object.segment);
        let objects = objects.filter(|segment| segment.kind != SegmentKind::Sky);
        let objects = objects.map(|segment| [segment.start, segment.end]);
        let path = self.path.windows(2).map(|leg| [leg[0], leg[1]]);
        let others = self
            .planes
            .iter()
            .filter(|other| **other != self.planes[plane]);
        let lines = objects.chain(path).chain(others.copied());
        let lines: Vec<[[f64; 2]; 2]> = lines.map(|line| line.map(place)).collect();
        let is_clear = |number: [f64; 2]| {
            let apart = |other: &[f64; 2]| distance(number, [*other; 2]) >= 2.0 * BADGE;
            let beside = |line: &[[f64; 2]; 2]| distance(number, *line) >= BADGE + CLEAR;
            let [x, y] = number;
            let is_inside = (area.x + BADGE..=area.right() - BADGE).contains(&x)
                && (area.y + BADGE..=area.bottom() - BADGE).contains(&y);
            is_inside && taken.iter().all(apart) && lines.iter().all(beside)
        };
        let beyond = |end: [f64; 2], other: [f64; 2], far: u32, turn: i32| {
            let angle = libm::atan2(end[1] - other[1], end[0] - other[0]) + TURN * f64::from(turn);
            let far = BADGE + f64::from(far);
            [
                end[0] + far * libm::cos(angle),
                end[1] + far * libm::sin(angle),
            ]
        };
        let turns = [0, 1, -1, 2, -2, 3, -3, 4, -4];
        let all = (0..FARTHEST).flat_map(|far| {
            let ends = [[to, from], [from, to]].into_iter();
            ends.flat_map(move |[end, other]| {
                turns.map(|turn| [beyond(end, other, far, turn), end])
            })
        });
        let mut clear = all.into_iter().filter(|[number, _]| is_clear(*number));
        clear.next().unwrap_or_else(|| [beyond(to, from, 0, 0), to])
    }

    fn objects(&self, svg: &mut Svg, place: &dyn Fn([f64; 2]) -> [f64; 2]) {
        let mut hatching = Hatching::default();
        for DrawnObject { segment, light } in &self.objects {
            let ends = [segment.start, segment.end].map(place);
            let (color, width) = line_of(segment.kind);
            if segment.kind == SegmentKind::Surface {
                hatching.draw(svg, ends, [light[0], -light[1]]);
            }
            if segment.kind != SegmentKind::Sky {
                svg.line(ends[0], ends[1], Stroke::solid(color, 0.7 * width));
            }
        }
    }
}

/// The distance of a point from a line.
fn distance([x, y]: [f64; 2], [from, to]: [[f64; 2]; 2]) -> f64 {
    let along = [to[0] - from[0], to[1] - from[1]];
    let off = [x - from[0], y - from[1]];
    let square = (along[0] * along[0] + along[1] * along[1]).max(1e-18);
    let part = ((off[0] * along[0] + off[1] * along[1]) / square).clamp(0.0, 1.0);
    libm::hypot(off[0] - part * along[0], off[1] - part * along[1])
}

/// A scale bar.
fn bar(svg: &mut Svg, area: Area, scale: f64) {
    let most = 110.0 / scale;
    let decade = libm::pow(10.0, libm::floor(libm::log10(most)));
    let lengths = [5.0, 2.0, 1.0].map(|digit| digit * decade);
    let length = lengths
        .into_iter()
        .find(|length| *length <= most)
        .unwrap_or(decade);
    let [x, y] = [area.x, area.bottom() + 6.0];
    let right = x + scale * length;
    let stroke = Stroke::solid(INK, STROKE);
    svg.line([x, y], [right, y], stroke);
    for end in [x, right] {
        svg.line([end, y - 3.0], [end, y + 3.0], stroke);
    }
    let style = TextStyle::new([right + 6.0, y + 4.0], TICK_TEXT, Anchor::Start).fill(SOFT);
    svg.text(style, &format!("{} m", tidy(length)));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::section::Segment;

    /// A blocker stands at the usual position of the plane's number.
    #[test]
    fn the_number_of_a_plane_covers_no_blocker() {
        let blocker = DrawnObject {
            segment: Segment {
                kind: SegmentKind::Blocker,
                start: [0.0, 14.0],
                end: [0.0, 22.0],
                label: None,
            },
            light: [1.0, 0.0],
        };
        let world = DrawnWorld {
            path: Vec::new(),
            objects: vec![blocker],
            planes: vec![[[0.0, 0.0], [0.0, 10.0]]],
        };
        let at = |area: Area| world.free(0, &[], area, &|point| point)[0];
        let area = Area::new([-50.0, -50.0], [100.0, 100.0]);
        let number = at(area);
        assert!(distance(number, [[0.0, 14.0], [0.0, 22.0]]) >= BADGE + CLEAR);
        assert!(number[1] < -BADGE + 0.1, "beyond the other end: {number:?}");
        // The other end is at the border.
        let number = at(Area::new([-50.0, -3.0], [100.0, 100.0]));
        assert!(distance(number, [[0.0, 14.0], [0.0, 22.0]]) >= BADGE + CLEAR);
        assert!(number[1] > BADGE - 3.0, "{number:?}");
    }
}
