//! A place of a geometry.

use glam::{DVec2, DVec3};

/// A place of a geometry, in its coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Local {
    /// Of any length.
    pub(crate) normal: DVec3,
    /// The normal for shading.
    pub(crate) shading: DVec3,
    pub(crate) uv: DVec2,
    /// The way in which u grows.
    pub(crate) along_u: DVec3,
}
