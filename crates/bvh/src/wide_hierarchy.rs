//! A hierarchy with eight boxes in a node, for many triangles and incoherent rays.

use crate::build::{TreeKind, bvh};
use crate::collapse::{Collapsed, collapsed};
use crate::leaf::{self, Leaf, LeafRay};
use crate::space::{Space, single, vector};
use crate::wide::{NodeRay, Wide};
use fearless_simd::{Level, dispatch};
use glam::DVec3;
use rayon::prelude::*;
use std::fmt;

/// A hierarchy over primitives.
#[derive(Clone)]
pub struct WideHierarchy {
    /// The original indices, in the order of leaves.
    order: Vec<u32>,
    tree: Wide,
    leaves: Vec<Leaf>,
    space: Space,
    level: Level,
}

/// A primitive of a hierarchy.
#[derive(Clone, Copy, Debug)]
pub enum WidePrimitive {
    /// A triangle, given by its corners. A ray may meet it if it passes the triangle within
    /// rounding errors.
    Triangle([DVec3; 3]),
    /// A box, given by its lowest and its highest corner. A ray may meet it if it meets the box of
    /// its leaf.
    Box([DVec3; 2]),
}

impl WidePrimitive {
    fn bounds(self) -> [DVec3; 2] {
        match self {
            Self::Triangle([a, b, c]) => [a.min(b).min(c), a.max(b).max(c)],
            Self::Box(bounds) => bounds,
        }
    }

    /// The corners of a triangle. A box has no such corners, and its NaN corners are never
    /// rejected.
    fn corners(self) -> [DVec3; 3] {
        match self {
            Self::Triangle(corners) => corners,
            Self::Box(_) => [DVec3::NAN; 3],
        }
    }
}

impl WideHierarchy {
    /// Builds a hierarchy over indexed primitives. `origins` is the largest coordinate of the
    /// starting points of rays.
    #[must_use]
    pub fn new(
        count: usize,
        origins: f64,
        primitive: impl Fn(usize) -> WidePrimitive + Sync,
    ) -> Self {
        let bounds = |i: usize| primitive(i).bounds();
        let space = Space::around((0..count).map(bounds), origins);
        let bvh = bvh(count, &space, TreeKind::Collapsed, bounds);
        let Collapsed {
            mut nodes,
            leaves,
            depth,
        } = collapsed(&bvh);
        nodes.shrink_to_fit();
        let order = bvh.primitive_indices;
        let within = |[first, count]: &[u32; 2]| {
            let numbers = &order[*first as usize..(*first + *count) as usize];
            let corners = numbers.iter().map(|i| primitive(*i as usize).corners());
            Leaf::new(*first, corners.map(|of| of.map(|p| space.scaled(p))))
        };
        Self {
            leaves: leaves.par_iter().map(within).collect(),
            order,
            tree: Wide::new(nodes, depth),
            space,
            level: Level::new(),
        }
    }

    /// The primitives, in the order in which [`Self::along`] visits them.
    #[must_use]
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Visits the primitives that a ray may meet in a range of distances, approximately front to
    /// back. Distances are multiples of the length of `direction`, which is at least 1. `meet`
    /// returns the distance beyond which primitives can be skipped. Before the first hit, this
    /// distance is the end of the range.
    #[inline]
    pub fn along(
        &self,
        start: DVec3,
        direction: DVec3,
        range: [f64; 2],
        mut meet: impl FnMut(usize) -> f64,
    ) {
        let stretch = self.space.stretch(start, direction, range);
        let ray = NodeRay::new(stretch, direction);
        let meet = |i: usize| self.space.limit(meet(i), stretch.begin);
        let tolerance = single(self.space.unit * self.space.padding);
        let origin = vector(self.space.unit * stretch.origin);
        let visit = leaf::Leaves {
            leaves: &self.leaves,
            sight: LeafRay::new(origin, direction, tolerance),
            meet,
        };
        dispatch!(self.level, simd => self.tree.along(simd, &ray, visit));
    }
}

impl fmt::Debug for WideHierarchy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("WideHierarchy")
            .field("order", &self.order.len())
            .finish_non_exhaustive()
    }
}
