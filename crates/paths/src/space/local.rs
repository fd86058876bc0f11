//! A point of a geometry.

use glam::{DVec2, DVec3};

/// A point of a geometry, in local coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Local {
    /// The geometric normal, of any length.
    pub(crate) normal: DVec3,
    /// The shading normal.
    pub(crate) shading: DVec3,
    pub(crate) uv: DVec2,
    /// The direction in which u increases.
    pub(crate) along_u: DVec3,
}
