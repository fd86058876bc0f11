//! Light that comes to a place.

use etendue_world::Texture;
use glam::{DVec2, DVec3};

/// Light that comes to a place from one direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Incoming {
    /// Where it comes from, of unit length.
    pub(crate) toward: DVec3,
    /// How far the way must be clear; beyond all where light comes from far away.
    pub(crate) distance: f64,
    /// Radiance over the density; without a density, irradiance across `toward`.
    pub(crate) weight: f64,
    /// Density per solid angle; `None` where only this direction was possible.
    pub(crate) density: Option<f64>,
}

/// The direction and the distance from one place to another.
pub(super) fn way(from: DVec3, to: DVec3) -> (DVec3, f64) {
    let between = to - from;
    let distance = between.length();
    (between / distance, distance)
}

/// What a shape emits at texture coordinates to a direction from its surface: the same to all on its front.
pub(super) fn emitted(emission: &Texture, uv: DVec2, normal: DVec3, away: DVec3) -> f64 {
    if normal.dot(away) > 0.0 {
        emission.value(uv)
    } else {
        0.0
    }
}
