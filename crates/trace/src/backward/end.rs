//! The point where a ray traced back begins, and what it implies about the surface that the ray
//! reaches.

use etendue_field::Side;

/// The point at which a ray is evaluated, along its leg.
#[derive(Clone, Copy, Debug)]
pub(super) enum End {
    /// At a plane. Light that has left a surface, and would meet it again beyond the plane, does
    /// not count.
    Plane(f64, Side),
    /// At a surface that ends the ray.
    Surface(f64),
}

impl End {
    pub(super) fn at(self) -> (f64, Side) {
        match self {
            Self::Plane(distance, side) => (distance, side),
            Self::Surface(distance) => (distance, Side::Before),
        }
    }

    /// The distance up to which light may leave the surface at the beginning of the leg.
    pub(super) fn of_line(self) -> f64 {
        match self {
            Self::Plane(..) => f64::INFINITY,
            Self::Surface(distance) => distance,
        }
    }
}
