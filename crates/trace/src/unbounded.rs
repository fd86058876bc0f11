//! Opaque blockers that extend without bound in their plane.

use etendue_field::{HalfPlane, Hole};

/// An opaque blocker that extends without bound in its plane.
#[derive(Clone, Debug)]
pub(crate) enum Unbounded {
    HalfPlane(HalfPlane),
    /// All of the plane except a hole.
    Aperture(Hole),
}

impl Unbounded {
    /// Checks whether the blocker contains the point (x, y) of its plane.
    #[inline]
    pub(crate) fn contains(&self, x: f64, y: f64) -> bool {
        match self {
            Self::HalfPlane(half_plane) => half_plane.contains(x, y),
            Self::Aperture(hole) => !hole.contains(x, y),
        }
    }
}
