//! Detects overlaps of the shapes of a layer in O(n log n) steps.

use etendue_field::{HalfPlane, Shape};
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

/// A shape or a half-plane of a layer, by its index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Thing {
    Shape(usize),
    HalfPlane(usize),
}

/// The first two shapes or half-planes that overlap; all coordinates must be finite.
pub(super) fn overlap(shapes: &[Shape], half_planes: &[HalfPlane]) -> Option<[Thing; 2]> {
    // Among any three half-planes, two overlap, so only the first three are tested.
    let first = &half_planes[..half_planes.len().min(3)];
    let two = pairs(first.len()).find(|[i, j]| !facing_away(&first[*i], &first[*j]));
    if let Some(pair) = two {
        return Some(pair.map(Thing::HalfPlane));
    }
    let reached = shapes.iter().enumerate().find_map(|(i, shape)| {
        let j = first.iter().position(|half| reaches(shape, half))?;
        Some([Thing::Shape(i), Thing::HalfPlane(j)])
    });
    reached.or_else(|| Some(overlap_of_shapes(shapes)?.map(Thing::Shape)))
}

fn pairs(count: usize) -> impl Iterator<Item = [usize; 2]> {
    (0..count).flat_map(|j| (0..j).map(move |i| [i, j]))
}

/// Finds the first shape that overlaps another shape. Returns this shape and the first of the
/// shapes that it overlaps.
///
/// If shapes are disjoint, their bounding boxes overlap only where the shapes touch, or in the
/// corners of the boxes around discs. Few boxes of similar size overlap at any point, so few pairs
/// are tested.
fn overlap_of_shapes(shapes: &[Shape]) -> Option<[usize; 2]> {
    let indexed = shapes.iter().enumerate().map(|(i, shape)| {
        let [low, high] = corners(shape);
        GeomWithData::new(Rectangle::from_corners(low, high), i)
    });
    let tree = RTree::bulk_load(indexed.collect());
    shapes.iter().enumerate().find_map(|(i, shape)| {
        let [low, high] = corners(shape);
        let near = tree.locate_in_envelope_intersecting(AABB::from_corners(low, high));
        let near = near.map(|indexed| indexed.data);
        let others = near.filter(|j| *j != i && meet(shape, &shapes[*j]));
        Some([i, others.min()?])
    })
}

/// The lowest and the highest coordinates of a shape.
fn corners(shape: &Shape) -> [[f64; 2]; 2] {
    let bounds = shape.bounds();
    let [[left, right], [bottom, top]] = [bounds.extent(0), bounds.extent(1)];
    [[left, bottom], [right, top]]
}

/// An overlap up to this share of the sizes of the shapes counts as a rounding error. Shapes may
/// touch, and rounding may make touching shapes overlap.
const TOUCH: f64 = 1e-9;

fn meet(a: &Shape, b: &Shape) -> bool {
    let (p, q) = (a.bounds(), b.bounds());
    let gap = |axis: usize| {
        let between = (p.center[axis] - q.center[axis]).abs();
        let reach = 0.5 * (p.size[axis] + q.size[axis]);
        between - reach * (1.0 - TOUCH)
    };
    let bounds_meet = gap(0) < 0.0 && gap(1) < 0.0;
    bounds_meet
        && match (a, b) {
            (Shape::Rectangle(_), Shape::Rectangle(_)) => true,
            (Shape::Disc(a), Shape::Disc(b)) => {
                let between = libm::hypot(a.center[0] - b.center[0], a.center[1] - b.center[1]);
                between < (a.radius + b.radius) * (1.0 - TOUCH)
            }
            (Shape::Disc(disc), Shape::Rectangle(rectangle))
            | (Shape::Rectangle(rectangle), Shape::Disc(disc)) => {
                // The vector from the nearest point of the rectangle to the centre of the disc.
                let beyond = |axis: usize| {
                    let [low, high] = rectangle.extent(axis);
                    disc.center[axis] - disc.center[axis].clamp(low, high)
                };
                libm::hypot(beyond(0), beyond(1)) < disc.radius * (1.0 - TOUCH)
            }
        }
}

fn reaches(shape: &Shape, half_plane: &HalfPlane) -> bool {
    let [low, high] = shape.bounds().extent(half_plane.axis);
    let slack = TOUCH * (high - low);
    if half_plane.above {
        high > half_plane.edge + slack
    } else {
        low < half_plane.edge - slack
    }
}

/// Checks whether two half-planes are disjoint because they face away from each other.
fn facing_away(a: &HalfPlane, b: &HalfPlane) -> bool {
    let (above, below) = if a.above { (a, b) } else { (b, a) };
    a.axis == b.axis && a.above != b.above && below.edge <= above.edge
}
