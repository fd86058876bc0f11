//! A photon that arrives at the surface that ends a leg.

use crate::line::{direction, start};
use etendue_field::{Frame, TwoPlane};
use glam::DVec3;

/// A photon at a point of a surface, in the frame of a leg.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arrival {
    pub(crate) point: DVec3,
    /// The normal on the side from which the photon came.
    pub(crate) normal: DVec3,
    /// The normal on the side that the surface faces.
    pub(crate) facing: DVec3,
    /// The direction of travel, with component 1 along D.
    pub(crate) direction: DVec3,
    pub(crate) flux: f64,
}

impl Arrival {
    /// The photon on a ray at a distance; `normal` returns the normal of the surface at the
    /// photon's point.
    pub(crate) fn new(
        ray: &TwoPlane,
        distance: f64,
        normal: impl FnOnce(DVec3) -> DVec3,
        flux: f64,
    ) -> Self {
        let direction = direction(ray);
        let point = start(ray) + distance * direction;
        let facing = normal(point);
        Self {
            point,
            normal: -facing.dot(direction).signum() * facing,
            facing,
            direction,
            flux,
        }
    }

    /// Checks whether the photon arrives on the side that the surface faces.
    pub(crate) fn is_on_front(&self) -> bool {
        self.facing.dot(self.direction) < 0.0
    }

    /// This arrival, converted from the frame of one leg to the frame of another. The
    /// frames `from` and `to` are given in the frame at the light.
    pub(crate) fn moved(&self, from: &Frame, to: &Frame) -> Self {
        let vector = |v: DVec3| to.vector_to_local(from.vector_to_world(v));
        Self {
            point: to.to_local(from.to_world(self.point)),
            normal: vector(self.normal),
            facing: vector(self.facing),
            direction: vector(self.direction),
            flux: self.flux,
        }
    }
}

/// The ratio of a photon's contribution to radiance space to its flux, (1 + u² + v²)² =
/// 1/cos⁴θ.
#[inline]
pub(crate) fn radiance_per_flux(ray: &TwoPlane) -> f64 {
    let secant_squared = ray.secant_squared();
    secant_squared * secant_squared
}
