//! Holes of opaque screens.

use crate::{Disc, Rectangle, Shape};
use serde::Serialize;

/// A convex polygon in a plane orthogonal to the central ray, with coordinates relative to the ray.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ConvexPolygon {
    /// Corners (x, y), in metres, counter-clockwise if X points to the right and Y up.
    corners: Vec<[f64; 2]>,
    /// Whether the corners were given clockwise.
    #[serde(skip)]
    is_reversed: bool,
}

impl ConvexPolygon {
    /// Builds a polygon from corners in either order around it. Returns `None` unless the corners
    /// are at least three, are the corners of a convex polygon, and no three of them lie on a line.
    #[must_use]
    pub fn new(mut corners: Vec<[f64; 2]>) -> Option<Self> {
        let area = moments(&corners).area;
        let is_reversed = area < 0.0;
        if is_reversed {
            corners.reverse();
        }
        let polygon = Self {
            corners,
            is_reversed,
        };
        let others_inside = |(i, [a, b]): (usize, [[f64; 2]; 2])| {
            let count = polygon.corners.len();
            (2..count).all(|k| turn(a, b, polygon.corners[(i + k) % count]) > 0.0)
        };
        let is_convex = polygon.corners.len() >= 3
            && area.abs() > 0.0
            && area.is_finite()
            && polygon.edges().enumerate().all(others_inside);
        is_convex.then_some(polygon)
    }

    /// The corners, counter-clockwise, in metres.
    #[must_use]
    pub fn corners(&self) -> &[[f64; 2]] {
        &self.corners
    }

    /// The corners in the order in which [`new`](Self::new) received them, in metres.
    #[must_use]
    pub fn in_given_order(&self) -> Vec<[f64; 2]> {
        let mut corners = self.corners.clone();
        if self.is_reversed {
            corners.reverse();
        }
        corners
    }

    /// The two ends of each edge.
    pub fn edges(&self) -> impl Iterator<Item = [[f64; 2]; 2]> {
        let next = self.corners.iter().cycle().skip(1);
        self.corners.iter().zip(next).map(|(a, b)| [*a, *b])
    }

    /// Checks whether the point (x, y) lies in the polygon, its edges included.
    #[inline]
    #[must_use]
    pub fn contains(&self, x: f64, y: f64) -> bool {
        let mut previous = self.corners[self.corners.len() - 1];
        let mut inside = true;
        for corner in &self.corners {
            inside &= turn(previous, *corner, [x, y]) >= 0.0;
            previous = *corner;
        }
        inside
    }
}

/// Twice the signed area of a triangle. The area is positive if the corners are
/// counter-clockwise.
#[inline]
fn turn([ax, ay]: [f64; 2], [bx, by]: [f64; 2], [x, y]: [f64; 2]) -> f64 {
    (bx - ax) * (y - ay) - (by - ay) * (x - ax)
}

/// The hole of an opaque screen. Everything outside the hole is opaque.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Hole {
    /// A rectangle or a disc.
    Shape(Shape),
    /// A convex polygon.
    Polygon(ConvexPolygon),
}

/// The area, the centroid and the second moments of a hole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HoleMoments {
    /// Area, in square metres.
    pub area: f64,
    /// Centroid (x, y), in metres.
    pub centroid: [f64; 2],
    /// The covariance of a point that is uniformly distributed in the hole, in square metres.
    pub covariance: [[f64; 2]; 2],
}

impl Hole {
    /// Checks whether the point (x, y) lies in the hole, its edge included.
    #[inline]
    #[must_use]
    pub fn contains(&self, x: f64, y: f64) -> bool {
        match self {
            Self::Shape(shape) => shape.contains(x, y),
            Self::Polygon(polygon) => polygon.contains(x, y),
        }
    }

    /// The share of radiance that passes at (x, y): 1 in the hole and 0 elsewhere.
    #[inline]
    #[must_use]
    pub fn transmittance(&self, x: f64, y: f64) -> f64 {
        f64::from(u8::from(self.contains(x, y)))
    }

    /// The smallest rectangle that contains the hole.
    #[must_use]
    pub fn bounds(&self) -> Rectangle {
        let polygon = match self {
            Self::Shape(shape) => return shape.bounds(),
            Self::Polygon(polygon) => polygon,
        };
        let ends = [0, 1].map(|axis| {
            let along = polygon.corners.iter().map(|corner| corner[axis]);
            along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], t| {
                [low.min(t), high.max(t)]
            })
        });
        Rectangle {
            center: ends.map(|[low, high]| 0.5 * (low + high)),
            size: ends.map(|[low, high]| high - low),
        }
    }

    /// The interval along an axis (0 for x, 1 for y) in which a line along this axis
    /// crosses the hole, in metres. `at` is the other coordinate of the line. Returns `None` if the
    /// line misses the hole.
    #[must_use]
    pub fn chord(&self, axis: usize, at: f64) -> Option<[f64; 2]> {
        match self {
            Self::Shape(Shape::Rectangle(rectangle)) => {
                let [low, high] = rectangle.extent(1 - axis);
                (low <= at && at <= high).then(|| rectangle.extent(axis))
            }
            Self::Shape(Shape::Disc(Disc { center, radius })) => {
                let off = at - center[1 - axis];
                let half = (radius * radius - off * off).sqrt();
                (off.abs() <= *radius).then(|| [center[axis] - half, center[axis] + half])
            }
            Self::Polygon(polygon) => {
                let crossings = polygon.edges().filter_map(|[a, b]| {
                    let [from, to] = [a, b].map(|p| p[1 - axis] - at);
                    let t = from / (from - to);
                    ((from <= 0.0) != (to <= 0.0)).then(|| a[axis] + t * (b[axis] - a[axis]))
                });
                let none = [f64::INFINITY, f64::NEG_INFINITY];
                let [low, high] = crossings.fold(none, |[low, high], t| [low.min(t), high.max(t)]);
                (low <= high).then_some([low, high])
            }
        }
    }

    /// The distance from the point (x, y) to the opaque part of the screen, in metres. The
    /// distance is zero if the point is not in the hole.
    #[must_use]
    pub fn clearance(&self, x: f64, y: f64) -> f64 {
        let nearest = match self {
            Self::Shape(Shape::Rectangle(Rectangle { center, size })) => {
                let gap = |axis: usize| 0.5 * size[axis] - ([x, y][axis] - center[axis]).abs();
                gap(0).min(gap(1))
            }
            Self::Shape(Shape::Disc(Disc { center, radius })) => {
                radius - libm::hypot(x - center[0], y - center[1])
            }
            Self::Polygon(polygon) => {
                let gaps = polygon
                    .edges()
                    .map(|[a, b]| turn(a, b, [x, y]) / libm::hypot(b[0] - a[0], b[1] - a[1]));
                gaps.fold(f64::INFINITY, f64::min)
            }
        };
        nearest.max(0.0)
    }

    /// The hole after a scaling of its plane by a factor, which may be negative, and a
    /// shift in metres.
    #[must_use]
    pub fn mapped(&self, factor: f64, shift: [f64; 2]) -> Self {
        let place = |p: [f64; 2]| [0, 1].map(|axis| factor * p[axis] + shift[axis]);
        match self {
            Self::Shape(shape) => Self::Shape(shape.mapped(factor, shift)),
            // A negative factor turns the plane by half a turn, which keeps the order of corners.
            Self::Polygon(polygon) => Self::Polygon(ConvexPolygon {
                corners: polygon.corners.iter().map(|p| place(*p)).collect(),
                ..*polygon
            }),
        }
    }

    /// The area, the centroid and the second moments.
    #[must_use]
    pub fn moments(&self) -> HoleMoments {
        match self {
            Self::Shape(shape) => {
                let [xx, yy] = shape.variances();
                HoleMoments {
                    area: shape.area(),
                    centroid: shape.bounds().center,
                    covariance: [[xx, 0.0], [0.0, yy]],
                }
            }
            Self::Polygon(polygon) => moments(&polygon.corners),
        }
    }
}

/// The moments of a polygon: sums over the triangles between its first corner and its
/// edges. The area is negative if the corners are clockwise.
fn moments(corners: &[[f64; 2]]) -> HoleMoments {
    let origin = corners.first().copied().unwrap_or_default();
    let from = |p: [f64; 2]| [p[0] - origin[0], p[1] - origin[1]];
    let (mut area, mut first, mut second) = (0.0, [0.0; 2], [[0.0; 2]; 2]);
    for pair in corners.windows(2) {
        let [a, b] = [from(pair[0]), from(pair[1])];
        let part = 0.5 * (a[0] * b[1] - a[1] * b[0]);
        area += part;
        for i in 0..2 {
            first[i] += part * (a[i] + b[i]) / 3.0;
            for j in 0..2 {
                // ∫ xᵢ xⱼ over the triangle (0, a, b).
                let sum = [a[i] + b[i], a[j] + b[j]];
                second[i][j] += part * (a[i] * a[j] + b[i] * b[j] + sum[0] * sum[1]) / 12.0;
            }
        }
    }
    let mean = first.map(|sum| sum / area);
    HoleMoments {
        area,
        centroid: [0, 1].map(|i| origin[i] + mean[i]),
        covariance: [0, 1].map(|i| [0, 1].map(|j| second[i][j] / area - mean[i] * mean[j])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pentagon() -> ConvexPolygon {
        let corners = [[0.3, -0.2], [0.9, 0.1], [0.8, 0.7], [0.2, 0.9], [-0.1, 0.4]];
        ConvexPolygon::new(corners.to_vec()).unwrap()
    }

    fn holes() -> [Hole; 3] {
        let center = [0.3, -0.1];
        let size = [0.8, 0.5];
        [
            Hole::Shape(Shape::Rectangle(Rectangle { center, size })),
            Hole::Shape(Shape::Disc(Disc {
                center,
                radius: 0.35,
            })),
            Hole::Polygon(pentagon()),
        ]
    }

    #[test]
    fn corners_may_go_round_either_way() {
        let mut reversed = pentagon().corners;
        reversed.reverse();
        let reversed = ConvexPolygon::new(reversed).unwrap();
        assert!(moments(reversed.corners()).area > 0.0);
        assert!(reversed.contains(0.4, 0.4) && !reversed.contains(0.9, 0.9));
    }

    #[test]
    fn other_corners_are_refused() {
        let star: Vec<[f64; 2]> = (0..5)
            .map(|i| {
                let (sin, cos) = libm::sincos(f64::from(i) * 0.8 * std::f64::consts::PI);
                [cos, sin]
            })
            .collect();
        let dart = vec![[0.0, 0.0], [1.0, 1.0], [0.0, 0.3], [-1.0, 1.0]];
        let crossed = vec![[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
        let straight = vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [1.0, 1.0]];
        let line = vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]];
        let twice = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let infinite = vec![[0.0, 0.0], [f64::INFINITY, 0.0], [0.0, 1.0]];
        let two = vec![[0.0, 0.0], [1.0, 0.0]];
        for corners in [
            star,
            dart,
            crossed,
            straight,
            line,
            twice,
            infinite,
            two,
            vec![],
        ] {
            assert_eq!(ConvexPolygon::new(corners.clone()), None, "{corners:?}");
        }
    }

    /// Compares bounds, chords and moments with sums over a fine grid of points.
    #[test]
    fn properties_are_those_of_the_points_inside() {
        const FINE: i32 = 2000;
        let step = 2.4 / f64::from(FINE);
        let along = |i: i32| -1.2 + (f64::from(i) + 0.5) * step;
        for hole in holes() {
            let [[left, right], [low, high]] = [0, 1].map(|axis| hole.bounds().extent(axis));
            let (mut count, mut first, mut second) = (0.0, [0.0; 2], [[0.0; 2]; 2]);
            for (i, j) in (0..FINE).flat_map(|i| (0..FINE).map(move |j| (i, j))) {
                let at = [along(i), along(j)];
                if !hole.contains(at[0], at[1]) {
                    assert_eq!(hole.clearance(at[0], at[1]).to_bits(), 0.0_f64.to_bits());
                    continue;
                }
                assert!(left <= at[0] && at[0] <= right && low <= at[1] && at[1] <= high);
                let [from, to] = hole.chord(0, at[1]).unwrap();
                assert!(from - 1e-12 <= at[0] && at[0] <= to + 1e-12);
                count += 1.0;
                for k in 0..2 {
                    first[k] += at[k];
                    for l in 0..2 {
                        second[k][l] += at[k] * at[l];
                    }
                }
            }
            let moments = hole.moments();
            let mean = first.map(|sum| sum / count);
            // The edge of the hole cuts cells, so sums are accurate to about a cell in a thousand.
            assert!((count * step * step / moments.area - 1.0).abs() < 2e-3);
            for k in 0..2 {
                assert!((mean[k] - moments.centroid[k]).abs() < 1e-3);
                for l in 0..2 {
                    let covariance = second[k][l] / count - mean[k] * mean[l];
                    assert!((covariance - moments.covariance[k][l]).abs() < 5e-4);
                }
            }
        }
    }

    #[test]
    fn a_circle_of_the_size_of_the_clearance_fits() {
        for hole in holes() {
            let [x, y] = hole.moments().centroid;
            let [x, y] = [x + 0.05, y - 0.03];
            let around = |radius: f64| {
                let angles = (0..720).map(|i| f64::from(i).to_radians() / 2.0);
                angles
                    .map(libm::sincos)
                    .all(|(sin, cos)| hole.contains(x + radius * cos, y + radius * sin))
            };
            let clearance = hole.clearance(x, y);
            assert!(around(0.999 * clearance) && !around(1.001 * clearance));
        }
    }

    #[test]
    fn a_mapped_hole_contains_mapped_points() {
        for hole in holes() {
            for factor in [-0.7, 2.0] {
                let mapped = hole.mapped(factor, [0.1, -0.4]);
                for i in 0..400 {
                    let [x, y] = [f64::from(i % 20), f64::from(i / 20)].map(|t| 0.11 * t - 1.0);
                    let found = mapped.contains(factor * x + 0.1, factor * y - 0.4);
                    assert_eq!(found, hole.contains(x, y));
                }
            }
        }
    }
}
