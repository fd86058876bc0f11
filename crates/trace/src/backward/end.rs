//! The point where a ray traced back begins, and what this implies about the surface it comes to.

use etendue_field::Side;

/// The point at which a ray is evaluated, along its leg.
#[derive(Clone, Copy, Debug)]
pub(super) enum End {
    /// At a plane. Light that would meet again, beyond the plane, the surface it has left does not
    /// count.
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
