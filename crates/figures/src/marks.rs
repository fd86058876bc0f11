//! Draws the marks that appear both in the cut and in the drawing to scale: plane numbers, segment
//! lines and hatching.

use crate::section::SegmentKind;
use crate::sizes::{FAINT, INK};
use crate::svg::{Anchor, Stroke, Svg, TextStyle};

pub(crate) const LIGHT: &str = "#f0a000";
const GLASS: &str = "#3a9bb0";
pub(crate) const PLANE: &str = "#1f5fa8";
/// Radius of the disk with a plane's number.
pub(crate) const BADGE: f64 = 8.0;
/// Depth of the hatching behind surfaces.
pub(crate) const HATCH: f64 = 9.0;

/// Draws a plane's number, counted from 1, on a disk.
pub(crate) fn badge(svg: &mut Svg, [x, y]: [f64; 2], plane: usize) {
    svg.circle([x, y], BADGE, PLANE);
    let style = TextStyle::new([x, y + 3.8], 10.5, Anchor::Middle)
        .bold()
        .fill("white");
    svg.text(style, &(plane + 1).to_string());
}

/// Draws the arrowhead of the central ray.
pub(crate) fn arrow(svg: &mut Svg, from: [f64; 2], to: [f64; 2]) {
    let along = [to[0] - from[0], to[1] - from[1]];
    let length = libm::hypot(along[0], along[1]).max(1e-9);
    let [a, b] = along.map(|a| a / length);
    let wings = [-3.5, 3.5].map(|wing| [to[0] - 9.0 * a - wing * b, to[1] - 9.0 * b + wing * a]);
    svg.polygon(&[to, wings[0], wings[1]], INK);
}

/// The color and the line width of a segment.
pub(crate) fn line_of(kind: SegmentKind) -> (&'static str, f64) {
    match kind {
        SegmentKind::Light => (LIGHT, 6.0),
        SegmentKind::Blocker => (INK, 4.5),
        SegmentKind::Surface => (INK, 1.6),
        SegmentKind::Glass => (GLASS, 1.8),
        SegmentKind::Sky => (LIGHT, 0.0),
    }
}

/// Short slanted strokes behind a surface, at equal distances along all segments of the surface.
#[derive(Debug, Default)]
pub(crate) struct Hatching {
    /// End of the last hatched segment, and the distance between this end and the last stroke.
    last: Option<([f64; 2], f64)>,
}

impl Hatching {
    /// Hatches a segment on the side towards which light travels.
    pub(crate) fn draw(&mut self, svg: &mut Svg, [start, end]: [[f64; 2]; 2], light: [f64; 2]) {
        const STEP: f64 = 6.0;
        let along = [end[0] - start[0], end[1] - start[1]];
        let length = libm::hypot(along[0], along[1]);
        if length == 0.0 {
            return;
        }
        let mut normal = [along[1] / length, -along[0] / length];
        if normal[0] * light[0] + normal[1] * light[1] < 0.0 {
            normal = normal.map(|n| -n);
        }
        let stroke = Stroke::solid(FAINT, 1.0);
        let near = |a: [f64; 2]| libm::hypot(a[0] - start[0], a[1] - start[1]) < 0.1;
        let behind = self.last.filter(|(point, _)| near(*point));
        let mut at = behind.map_or(HATCH, |(_, behind)| STEP - behind);
        // The limit bounds the number of strokes on extremely long segments.
        while at < length.min(20_000.0) {
            let [x, y] = [0, 1].map(|i| start[i] + along[i] * at / length);
            let back = [0, 1].map(|i| [x, y][i] + HATCH * normal[i] - HATCH * along[i] / length);
            svg.line([x, y], back, stroke);
            at += STEP;
        }
        self.last = Some((end, length + STEP - at));
    }
}
