//! Defines where a backward ray begins, and on which part of its line light may leave the next
//! surface.

use crate::plane_on_leg::PlaneOnLeg;
use etendue_field::Side;

/// The point along a leg at which the radiance of a ray is evaluated.
#[derive(Clone, Copy, Debug)]
pub(super) enum End {
    /// A virtual plane. Light that has left a surface and would meet the same surface again beyond
    /// the plane does not count.
    Plane(f64, Side),
    /// A virtual plane on the surface that ends the leg: the same, but light that leaves a surface
    /// beyond this point does not count either.
    OnSurface(f64),
    /// A surface that ends the ray.
    Surface(f64),
}

impl End {
    /// The end at a point of a virtual plane, at a distance along the plane's leg.
    pub(super) fn at_plane(plane_on_leg: &PlaneOnLeg, distance: f64) -> Self {
        match (plane_on_leg.side, plane_on_leg.view()) {
            (Side::Before, Some(_)) => Self::OnSurface(distance),
            (side, _) => Self::Plane(distance, side),
        }
    }

    pub(super) fn at(self) -> (f64, Side) {
        match self {
            Self::Plane(distance, side) => (distance, side),
            Self::OnSurface(distance) | Self::Surface(distance) => (distance, Side::Before),
        }
    }

    /// The distance along the leg up to which light may leave the surface at the
    /// beginning of the leg.
    pub(super) fn of_line(self) -> f64 {
        match self {
            Self::Plane(..) | Self::OnSurface(_) => f64::INFINITY,
            Self::Surface(distance) => distance,
        }
    }
}
