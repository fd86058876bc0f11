//! Maps from the unit square to discs, triangles and directions.

use etendue_field::{Frame, sincos_turns};
use glam::{DVec2, DVec3};
use std::f64::consts::FRAC_1_PI;

/// Samples a point uniformly from a disc about the origin.
#[inline]
#[must_use]
pub fn disc(radius: f64, [a, b]: [f64; 2]) -> DVec2 {
    let (sin, cos) = sincos_turns(b);
    radius * a.sqrt() * DVec2::new(cos, sin)
}

/// Samples a point uniformly from a triangle: returns its barycentric coordinates at the second and
/// at the third corner.
#[inline]
#[must_use]
pub fn triangle([a, b]: [f64; 2]) -> DVec2 {
    let root = a.sqrt();
    DVec2::new(root * (1.0 - b), root * b)
}

/// Samples a direction uniformly from the sphere.
#[inline]
#[must_use]
pub fn sphere([a, b]: [f64; 2]) -> DVec3 {
    polar(2.0 * a, b)
}

/// Samples a direction with z > 0 in proportion to its cosine to Z. By Malley's method, a point is
/// sampled in the unit disc and projected up to the hemisphere.
#[inline]
#[must_use]
pub fn cosine_hemisphere([a, b]: [f64; 2]) -> DVec3 {
    disc(1.0, [a, b]).extend((1.0 - a).sqrt())
}

/// The density of [`cosine_hemisphere`], over the whole sphere.
#[inline]
#[must_use]
pub fn cosine_hemisphere_density(direction: DVec3) -> f64 {
    direction.z.max(0.0) * FRAC_1_PI
}

/// The direction at an angle θ to Z and an azimuth φ. `fall` is 1 − cos θ, which keeps its
/// digits for small θ, and `turn` is φ/2π.
#[inline]
#[must_use]
pub fn polar(fall: f64, turn: f64) -> DVec3 {
    let sine = (fall * (2.0 - fall)).max(0.0).sqrt();
    let (sin, cos) = sincos_turns(turn);
    DVec3::new(sine * cos, sine * sin, 1.0 - fall)
}

/// Converts a direction from a frame with Z along `axis` to the coordinates in which `axis` is
/// given. The frame results from turning the axes of these coordinates by the smallest angle.
#[inline]
#[must_use]
pub fn about(axis: DVec3, local: DVec3) -> DVec3 {
    Frame::IDENTITY.turned_to(axis).vector_to_world(local)
}

/// Samples a number in (−1, 1) with density 1 − |t|.
#[inline]
pub(crate) fn tent(r: f64) -> f64 {
    if r < 0.5 {
        (2.0 * r).sqrt() - 1.0
    } else {
        1.0 - (2.0 * (1.0 - r)).sqrt()
    }
}
