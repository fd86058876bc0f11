//! Masks of the plain tracer, as docs/scene.md describes them.

use super::world::{grating, number};
use crate::second::pattern::cosine;
use crate::second::vector::{Axes, Vector, dot, plus};
use etendue_field::Grating;
use etendue_scene::{BlockersFile, HalfName, HoleFile, ShapeFile};
use etendue_transform::random::{self, Stream};

/// A mask around the origin of its axes, which are parallel to those of the light.
pub(super) struct PlainMask {
    axes: Axes,
    what: What,
}

enum What {
    Shapes(Vec<ShapeFile>),
    Hole(HoleFile),
    Grating(Grating),
}

impl PlainMask {
    /// Returns `None` for meshes and pictures.
    pub(super) fn new(file: &BlockersFile, axes: impl Fn(Vector) -> Axes) -> Option<Self> {
        let rectangle = |center: [f64; 2], size: [f64; 2]| ShapeFile::Rectangle { center, size };
        let middle = |i: u32, count: u32| f64::from(i) - 0.5 * (f64::from(count) - 1.0);
        let (center, what) = match file {
            BlockersFile::JitteredSquares {
                center,
                count,
                pitch,
                fill,
                jitter,
                seed,
                ..
            } => {
                let cells = (0..count[0]).flat_map(|i| (0..count[1]).map(move |j| [i, j]));
                let squares = cells.map(|[i, j]| {
                    let index = u64::from(i) * u64::from(count[1]) + u64::from(j);
                    let words = random::words(*seed, Stream::Jitter, index, 0);
                    let moved = |word: u32| jitter * (random::unit(word) - 0.5);
                    let x = pitch * (middle(i, count[0]) + moved(words[0]));
                    let y = pitch * (middle(j, count[1]) + moved(words[1]));
                    rectangle([x, y], [fill * pitch; 2])
                });
                (center, What::Shapes(squares.collect()))
            }
            BlockersFile::Bars {
                center,
                axis,
                count,
                pitch,
                fill,
                ..
            } => {
                let bars = (0..*count).map(|i| {
                    let (mut at, mut size) = ([0.0; 2], [f64::INFINITY; 2]);
                    at[number(*axis)] = pitch * middle(i, *count);
                    size[number(*axis)] = fill * pitch;
                    rectangle(at, size)
                });
                (center, What::Shapes(bars.collect()))
            }
            BlockersFile::Shapes { center, shapes, .. } => (center, What::Shapes(shapes.clone())),
            BlockersFile::Aperture { center, hole, .. } => (center, What::Hole(hole.clone())),
            BlockersFile::Grating {
                center,
                axis,
                frequency,
                modulation,
                phase,
                ..
            } => {
                let grating = grating(*axis, [*frequency, *modulation, *phase]);
                (center, What::Grating(grating))
            }
            BlockersFile::Picture { .. } | BlockersFile::Mesh { .. } => return None,
        };
        let axes = axes(*center);
        Some(Self { axes, what })
    }

    /// The share of light that passes on a ray between two of its distances.
    pub(super) fn passes(&self, start: Vector, along: Vector, [from, to]: [f64; 2]) -> f64 {
        let [.., height] = self.axes.coordinates(start);
        let t = -height / dot(along, self.axes.d);
        if !(from < t && t < to) {
            return 1.0;
        }
        let [x, y, _] = self.axes.coordinates(plus(start, t, along));
        let is_opaque = match &self.what {
            What::Grating(grating) => return cosine(grating, [x, y], ""),
            What::Shapes(shapes) => shapes.iter().any(|shape| contains(shape, [x, y])),
            What::Hole(hole) => !is_in_hole(hole, [x, y]),
        };
        if is_opaque { 0.0 } else { 1.0 }
    }
}

fn contains(shape: &ShapeFile, [x, y]: [f64; 2]) -> bool {
    match shape {
        ShapeFile::Rectangle { center, size } => {
            2.0 * (x - center[0]).abs() <= size[0] && 2.0 * (y - center[1]).abs() <= size[1]
        }
        ShapeFile::Disc { center, radius } => (x - center[0]).hypot(y - center[1]) <= *radius,
        ShapeFile::HalfPlane { axis, edge, opaque } => {
            let at = [x, y][number(*axis)];
            match opaque {
                HalfName::Above => at >= *edge,
                HalfName::Below => at <= *edge,
            }
        }
    }
}

/// A point is in a polygon if a line from it to the right crosses the edges an odd number of times.
pub(crate) fn is_in_hole(hole: &HoleFile, [x, y]: [f64; 2]) -> bool {
    match hole {
        HoleFile::Disc { center, radius } => (x - center[0]).hypot(y - center[1]) <= *radius,
        HoleFile::Rectangle { center, size } => {
            2.0 * (x - center[0]).abs() <= size[0] && 2.0 * (y - center[1]).abs() <= size[1]
        }
        HoleFile::Polygon { corners } => {
            let edges = corners.iter().zip(corners.iter().cycle().skip(1));
            let crossed = edges.filter(|(a, b)| {
                (a[1] > y) != (b[1] > y) && a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) > x
            });
            crossed.count() % 2 == 1
        }
    }
}
