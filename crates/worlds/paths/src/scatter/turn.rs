//! Flips directions, so that a chosen side is in front.

use glam::DVec3;

/// Returns the flip after which `wo` is in front.
#[inline]
pub(super) fn to_front(wo: DVec3) -> impl Fn(DVec3) -> DVec3 + Copy {
    let side = if wo.z > 0.0 { 1.0 } else { -1.0 };
    move |v| v.with_z(side * v.z)
}
