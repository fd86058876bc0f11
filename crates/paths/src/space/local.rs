//! A point of a geometry.

use etendue_world::TexturePoint;
use glam::DVec3;

/// A point of a geometry, in local coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Local {
    /// The geometric normal, of any length.
    pub(crate) normal: DVec3,
    /// The shading normal.
    pub(crate) shading: DVec3,
    /// The point as textures see it.
    pub(crate) point: TexturePoint,
    /// The direction in which u increases.
    pub(crate) along_u: DVec3,
}
