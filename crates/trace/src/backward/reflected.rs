//! A point at which a surface with a BRDF reflects light.

use etendue_field::{Frame, Mixture};
use glam::DVec3;

/// A point at which light is reflected, in the frame at the light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reflection<'a> {
    pub(super) brdf: Mixture<'a>,
    pub(super) point: DVec3,
    /// D along the normal.
    pub(super) frame: Frame,
    /// Where light goes, of unit length, in that frame.
    pub(super) to: DVec3,
}
