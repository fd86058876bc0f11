//! Lambert's BRDF of albedo 1, the same in all directions before the surface.

use glam::DVec3;
use std::f64::consts::{FRAC_1_PI, TAU};

/// The BRDF between two directions before the surface.
pub const VALUE: f64 = FRAC_1_PI;

/// A direction before the surface, by its cosine.
#[inline]
#[must_use]
pub fn sample([a, b]: [f64; 2]) -> DVec3 {
    let (sin, cos) = libm::sincos(TAU * b);
    let across = a.sqrt();
    DVec3::new(across * cos, across * sin, (1.0 - a).sqrt())
}

/// The density of [`sample`], over the whole sphere.
#[inline]
#[must_use]
pub fn density(wi: DVec3) -> f64 {
    wi.z.max(0.0) * FRAC_1_PI
}
