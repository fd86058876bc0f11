//! Where rays traced back begin, and what that says of the surface they come to.

use etendue_field::Side;

/// Where a ray is looked at, along its leg.
#[derive(Clone, Copy, Debug)]
pub(super) enum End {
    /// At a plane. What would meet again beyond it the surface that it has left does not count.
    Plane(f64, Side),
    /// At a surface, beyond which it does not go.
    Surface(f64),
}

impl End {
    pub(super) fn at(self) -> (f64, Side) {
        match self {
            Self::Plane(distance, side) => (distance, side),
            Self::Surface(distance) => (distance, Side::Before),
        }
    }

    /// Up to where light may leave the surface at the beginning of the leg.
    pub(super) fn of_line(self) -> f64 {
        match self {
            Self::Plane(..) => f64::INFINITY,
            Self::Surface(distance) => distance,
        }
    }
}
