//! Defines where a backward ray begins, and on which part of its line light may leave the next
//! surface.

use etendue_field::Side;

/// The point along a leg at which the radiance of a ray is evaluated.
#[derive(Clone, Copy, Debug)]
pub(super) enum End {
    /// A virtual plane. Light that has left a surface and would meet the same surface again beyond
    /// the plane does not count.
    Plane(f64, Side),
    /// A surface that ends the ray.
    Surface(f64),
}

impl End {
    pub(super) fn at(self) -> (f64, Side) {
        match self {
            Self::Plane(distance, side) => (distance, side),
            Self::Surface(distance) => (distance, Side::Before),
        }
    }

    /// Returns the distance along the leg up to which light may leave the surface at the
    /// beginning of the leg.
    pub(super) fn of_line(self) -> f64 {
        match self {
            Self::Plane(..) => f64::INFINITY,
            Self::Surface(distance) => distance,
        }
    }
}
