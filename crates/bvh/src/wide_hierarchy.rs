//! A hierarchy with eight boxes in a node, for many triangles and incoherent rays.

use crate::build::{TreeKind, bvh};
use crate::collapse;
use crate::leaf::{self, Leaf, LeafRay};
use crate::single::single;
use crate::space::{Space, vector};
use crate::wide::{NodeRay, Visit, Wide};
use fearless_simd::{Level, Simd, dispatch};
use glam::DVec3;
use rayon::prelude::*;
use std::fmt;

/// A hierarchy over boxes or triangles.
#[derive(Clone)]
pub struct WideHierarchy {
    /// The original indices, in the order of leaves.
    order: Vec<u32>,
    tree: Wide,
    leaves: TreeLeaves,
    space: Space,
    level: Level,
}

/// The contents of the leaves of a tree.
#[derive(Clone)]
enum TreeLeaves {
    /// The first box and the number of boxes.
    Boxes(Vec<[u32; 2]>),
    Triangles(Vec<Leaf>),
}

impl WideHierarchy {
    /// Builds a hierarchy over indexed boxes, given by their lowest and highest corners.
    /// `origins` is the largest coordinate of the starting points of rays.
    #[must_use]
    pub fn new(count: usize, origins: f64, bounds: impl Fn(usize) -> [DVec3; 2] + Sync) -> Self {
        let space = Space::around((0..count).map(&bounds), origins);
        let bvh = bvh(count, &space, TreeKind::Collapsed, bounds);
        let (tree, leaves) = collapse::collapsed(&bvh);
        Self {
            order: bvh.primitive_indices,
            tree,
            leaves: TreeLeaves::Boxes(leaves),
            space,
            level: Level::new(),
        }
    }

    /// Builds a hierarchy over indexed triangles, given by their corners.
    #[must_use]
    pub fn over_triangles(
        count: usize,
        origins: f64,
        corners: impl Fn(usize) -> [DVec3; 3] + Sync,
    ) -> Self {
        let boxes = Self::new(count, origins, |i| {
            let [a, b, c] = corners(i);
            [a.min(b).min(c), a.max(b).max(c)]
        });
        let TreeLeaves::Boxes(leaves) = &boxes.leaves else {
            return boxes;
        };
        let within = |[first, count]: &[u32; 2]| {
            let numbers = &boxes.order[*first as usize..(*first + *count) as usize];
            let corners = numbers.iter().map(|i| corners(*i as usize));
            Leaf::new(*first, corners.map(|of| of.map(|p| boxes.space.scaled(p))))
        };
        let leaves = TreeLeaves::Triangles(leaves.par_iter().map(within).collect());
        Self { leaves, ..boxes }
    }

    /// Returns the boxes or triangles, in the order in which [`Self::along`] visits them.
    #[must_use]
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Visits the boxes or triangles that a ray may meet in a range of distances, approximately
    /// front to back. Distances are multiples of the length of `direction`, which is at least 1.
    /// `meet` returns the distance beyond which boxes or triangles can be skipped. Before the first
    /// hit, this distance is the end of the range.
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
        match &self.leaves {
            TreeLeaves::Boxes(leaves) => {
                let visit = Boxes { leaves, meet };
                dispatch!(self.level, simd => self.tree.along(simd, &ray, visit));
            }
            TreeLeaves::Triangles(leaves) => {
                let tolerance = single(self.space.unit * self.space.padding);
                let origin = vector(self.space.unit * stretch.origin);
                let visit = leaf::TriangleLeaves {
                    leaves,
                    sight: LeafRay::new(origin, direction, tolerance),
                    meet,
                };
                dispatch!(self.level, simd => self.tree.along(simd, &ray, visit));
            }
        }
    }
}

/// The leaves of a tree of boxes. Each visit passes all boxes of a leaf to the caller in sequence.
struct Boxes<'a, M> {
    leaves: &'a [[u32; 2]],
    meet: M,
}

impl<M: FnMut(usize) -> f32> Visit for Boxes<'_, M> {
    #[inline(always)]
    fn visit<S: Simd>(&mut self, _: S, leaf: usize) -> f32 {
        let [first, count] = self.leaves[leaf];
        let mut until = f32::INFINITY;
        for i in first..first + count {
            until = until.min((self.meet)(i as usize));
        }
        until
    }
}

impl fmt::Debug for WideHierarchy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("WideHierarchy")
            .field("order", &self.order.len())
            .finish_non_exhaustive()
    }
}
