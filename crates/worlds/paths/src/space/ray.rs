//! Rays of worlds, given by origin and direction.

use glam::DVec3;

/// A ray. Distances along the ray are multiples of `along`, which has length 1.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Its origin.
    pub from: DVec3,
    /// Its direction.
    pub along: DVec3,
}

impl Ray {
    pub(crate) fn at(&self, distance: f64) -> DVec3 {
        self.from + distance * self.along
    }
}
