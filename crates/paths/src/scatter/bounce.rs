//! Directions that a path goes on to.

use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// A direction that a path goes on to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounce {
    /// Where light comes from, in the frame of the surface.
    pub(crate) wi: DVec3,
    /// BSDF times |cos| of wi over its density.
    pub(crate) weight: f64,
    /// Density per solid angle; `None` where only this direction was possible.
    pub(crate) density: Option<f64>,
}

/// A direction mirrored at a normal.
pub(super) fn mirrored(direction: DVec3, normal: DVec3) -> DVec3 {
    2.0 * direction.dot(normal) * normal - direction
}

/// A direction about Z by its cosine.
pub(super) fn by_cosine([a, b]: [f64; 2]) -> DVec3 {
    let (sin, cos) = libm::sincos(TAU * b);
    let radius = a.sqrt();
    DVec3::new(radius * cos, radius * sin, (1.0 - a).sqrt())
}

/// The density of [`by_cosine`].
pub(super) fn cosine_density(direction: DVec3) -> f64 {
    direction.z.max(0.0) / PI
}
