//! A hierarchy with two boxes in a node, for scenes with few primitives.

use crate::build::{TreeKind, bvh};
use crate::space::{Space, vector};
use glam::DVec3;
use obvhs::bvh2::Bvh2;
use obvhs::ray::{Ray, RayHit};
use std::fmt;

/// A hierarchy over boxes.
#[derive(Clone)]
pub struct BinaryHierarchy {
    bvh: Bvh2,
    space: Space,
}

impl BinaryHierarchy {
    /// Builds a hierarchy over indexed boxes, given by their lowest and highest corners.
    /// `origins` is the largest coordinate of the starting points of rays.
    #[must_use]
    pub fn new(count: usize, origins: f64, bounds: impl Fn(usize) -> [DVec3; 2] + Sync) -> Self {
        let space = Space::around((0..count).map(&bounds), origins);
        let bvh = bvh(count, &space, TreeKind::Binary, bounds);
        Self { bvh, space }
    }

    /// The boxes, in the order in which [`Self::along`] visits them.
    #[must_use]
    pub fn order(&self) -> &[u32] {
        &self.bvh.primitive_indices
    }

    /// Visits the boxes that a ray may meet in a range of distances, approximately front to back.
    /// Distances are multiples of the length of `direction`, which is at least 1. `meet` returns
    /// the distance beyond which boxes can be skipped. Before the first hit, this distance is the
    /// end of the range.
    #[inline]
    pub fn along(
        &self,
        start: DVec3,
        direction: DVec3,
        range: [f64; 2],
        mut meet: impl FnMut(usize) -> f64,
    ) {
        let stretch = self.space.stretch(start, direction, range);
        let origin = vector(stretch.origin);
        let ray = Ray::new(origin, vector(direction), 0.0, stretch.until);
        let meet = |_: &Ray, i| self.space.limit(meet(i), stretch.begin);
        self.bvh.ray_traverse(ray, &mut RayHit::none(), meet);
    }
}

impl fmt::Debug for BinaryHierarchy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("BinaryHierarchy")
            .field("boxes", &self.order().len())
            .finish_non_exhaustive()
    }
}
