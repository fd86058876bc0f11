//! A point at which a surface with a BRDF reflects light.

use etendue_field::{Frame, Mixture};
use glam::DVec3;

/// A point at which light is reflected, in the frame at the light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reflection<'a> {
    pub(super) brdf: Mixture<'a>,
    pub(super) point: DVec3,
    /// The frame whose D is the normal of the surface.
    pub(super) frame: Frame,
    /// The unit direction of the reflected light, in the frame of the normal.
    pub(super) to: DVec3,
}
