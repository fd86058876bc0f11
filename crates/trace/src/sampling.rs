//! Draws points and directions from uniform random numbers.

use etendue_field::Shape;
use glam::DVec2;
use std::f64::consts::PI;

/// π, the flux that a Lambertian surface emits per radiance and area.
pub(crate) const LAMBERTIAN: f64 = PI;

/// A point drawn uniformly in a shape, with two random numbers in (0, 1).
pub(crate) fn point(shape: &Shape, r: [f64; 2]) -> [f64; 2] {
    match shape {
        Shape::Rectangle(rectangle) => [0, 1].map(|axis| {
            let [low, high] = rectangle.extent(axis);
            low + r[axis] * (high - low)
        }),
        Shape::Disc(disc) => {
            let from_center = etendue_sampling::disc(disc.radius, r);
            (DVec2::from(disc.center) + from_center).to_array()
        }
    }
}
