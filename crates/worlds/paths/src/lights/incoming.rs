//! Incident light at a point.

use etendue_world::{Texture, TexturePoint};
use glam::DVec3;

/// Incident light at a point from one direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Incoming {
    /// The direction towards the light, of unit length.
    pub(crate) toward: DVec3,
    /// Light arrives only if there is no occluder up to this distance along the direction. For
    /// distant light, this distance is beyond all surfaces.
    pub(crate) distance: f64,
    /// Radiance divided by the density. If there is no density, this is the irradiance of a surface
    /// perpendicular to `toward`.
    pub(crate) weight: f64,
    /// Density per solid angle; `None` if only this direction is possible.
    pub(crate) density: Option<f64>,
}

impl Incoming {
    /// Returns light that arrives only from this direction.
    pub(super) fn from_one(toward: DVec3, distance: f64, weight: f64) -> Self {
        Self {
            toward,
            distance,
            weight,
            density: None,
        }
    }
}

/// The direction and the distance from one point to another.
#[inline]
pub(super) fn way(from: DVec3, to: DVec3) -> (DVec3, f64) {
    let between = to - from;
    let distance = between.length();
    (between / distance, distance)
}

/// The radiance that the front of a shape emits in a direction from a given point. The
/// radiance is the same in all directions.
#[inline]
pub(super) fn emitted(emission: &Texture, point: &TexturePoint, normal: DVec3, away: DVec3) -> f64 {
    if normal.dot(away) > 0.0 {
        emission.value(point)
    } else {
        0.0
    }
}
