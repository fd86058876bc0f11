//! The screen of an aperture, as triangles around its hole.

use etendue_field::{Hole, Shape};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// The number of corners of the polygon that replaces a disc.
const DISC_CORNERS: u32 = 1024;

/// The triangles of an opaque screen around a hole, at a distance from the light in metres.
/// The screen reaches beyond the square of coordinates of modulus up to `beyond`. Also returns the
/// largest distance between the edge of the hole and the edge of the triangles, in metres; it is
/// zero unless the hole is a disc.
pub(super) fn screen(hole: &Hole, distance: f64, beyond: f64) -> (Vec<[DVec3; 3]>, f64) {
    let (corners, error) = outline(hole);
    let [x, y] = hole.moments().centroid;
    // The outer edge of the screen is the edge of the hole, scaled about the centroid. The square
    // is within a circle about the centroid that the scaled hole contains.
    let farthest = libm::hypot(x.abs() + beyond, y.abs() + beyond);
    let factor = 1.0 + farthest / (hole.clearance(x, y) - error);
    let inner = |p: [f64; 2]| DVec3::new(p[0], p[1], distance);
    let outer = |p: [f64; 2]| inner([x + factor * (p[0] - x), y + factor * (p[1] - y)]);
    let next = corners.iter().cycle().skip(1);
    let triangles = corners.iter().zip(next).flat_map(|(a, b)| {
        let [a, b, c, d] = [inner(*a), inner(*b), outer(*b), outer(*a)];
        [[a, c, b], [a, d, c]]
    });
    (triangles.collect(), error)
}

/// The corners of a polygon that replaces a hole, and the largest distance between their
/// edges.
fn outline(hole: &Hole) -> (Vec<[f64; 2]>, f64) {
    match hole {
        Hole::Polygon(polygon) => (polygon.corners().to_vec(), 0.0),
        Hole::Shape(Shape::Rectangle(rectangle)) => {
            let [[left, right], [low, high]] = [rectangle.extent(0), rectangle.extent(1)];
            let corners = vec![[left, low], [right, low], [right, high], [left, high]];
            (corners, 0.0)
        }
        Hole::Shape(Shape::Disc(disc)) => {
            let corner = |i: u32| {
                let (sin, cos) = libm::sincos(TAU * f64::from(i) / f64::from(DISC_CORNERS));
                let [x, y] = disc.center;
                [x + disc.radius * cos, y + disc.radius * sin]
            };
            let half = libm::sin(0.5 * PI / f64::from(DISC_CORNERS));
            let error = 2.0 * disc.radius * half * half;
            ((0..DISC_CORNERS).map(corner).collect(), error)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_field::{ConvexPolygon, Disc, Rectangle, TwoPlane, triangle_distance};

    #[test]
    fn the_screen_covers_what_is_not_in_the_hole() {
        let center = [0.3, -0.2];
        let hexagon = [
            [0.5, 0.0],
            [0.3, 0.4],
            [-0.2, 0.4],
            [-0.5, 0.1],
            [-0.2, -0.3],
        ];
        let size = [0.4, 0.9];
        for hole in [
            Hole::Shape(Shape::Disc(Disc {
                center,
                radius: 0.4,
            })),
            Hole::Shape(Shape::Rectangle(Rectangle { center, size })),
            Hole::Polygon(ConvexPolygon::new(hexagon.to_vec()).unwrap()),
        ] {
            let (triangles, _) = screen(&hole, 1.0, 2.0);
            for i in 0..400 {
                let [x, y] = [i % 20, i / 20].map(|k| 0.21 * f64::from(k) - 1.99);
                let [u, v] = [0.0; 2];
                let ray = TwoPlane { x, y, u, v };
                let mut each = triangles.iter();
                let covered = each.any(|corners| triangle_distance(corners, &ray).is_some());
                assert_eq!(covered, !hole.contains(x, y), "({x}, {y})");
            }
        }
    }
}
