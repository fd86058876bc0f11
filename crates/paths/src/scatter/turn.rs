//! Flips directions, so that a chosen side is in front.

use glam::DVec3;

/// A function that flips directions so that a chosen side is in front.
pub(super) type Turn = fn(DVec3) -> DVec3;

/// Returns the flip after which `wo` is in front.
pub(super) fn to_front(wo: DVec3) -> Turn {
    if wo.z > 0.0 {
        |v| v
    } else {
        |v| v.with_z(-v.z)
    }
}
