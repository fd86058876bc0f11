//! A tree with eight boxes in a node, all tested against a ray at once.

use crate::space::{Stretch, vector};
use fearless_simd::{Simd, f32x8, prelude::*};
use glam::DVec3;

/// A tree; its root is the first node.
#[derive(Clone)]
pub(crate) struct Wide {
    nodes: Vec<Node>,
    /// The stack size that a traversal may need.
    memory: usize,
}

/// Number of boxes in a node.
pub(crate) const WIDTH: usize = 8;

/// Stack size without allocation. It is enough for the depth of any tree with a million triangles.
const STACK: usize = 96;

#[derive(Clone)]
#[repr(align(32))]
pub(crate) struct Node {
    /// Lowest x of all boxes, highest x, lowest y and so on. An empty slot has bounds that no ray
    /// meets.
    planes: [[f32; WIDTH]; 6],
    /// Indices of child nodes, or of leaves, which are marked by [`LEAF`].
    children: [u32; WIDTH],
}

/// The bit that distinguishes leaves from nodes.
const LEAF: u32 = 1 << 31;

/// A ray prepared for box tests.
pub(crate) struct NodeRay {
    origin: [f32; 3],
    /// The reciprocal of the ray's direction.
    turned: [f32; 3],
    /// Index of the plane that the ray crosses first, along each axis.
    first: [usize; 3],
    until: f32,
}

/// The smallest absolute component of a direction. Smaller components are replaced by this
/// smallest component, which does not move a ray noticeably and has a finite reciprocal.
const MIN_COMPONENT: f32 = 1e-20;

/// A child that has not been visited yet, and the distance along the ray at which its box begins.
#[derive(Clone, Copy, Default)]
struct Waiting {
    near: f32,
    child: u32,
}

/// The operation on the leaves that a ray reaches.
pub(crate) trait Visit {
    /// Visits a leaf and returns the distance beyond which boxes can be skipped.
    fn visit<S: Simd>(&mut self, simd: S, leaf: usize) -> f32;
}

impl<M: FnMut(usize) -> f32> Visit for M {
    #[inline(always)]
    fn visit<S: Simd>(&mut self, _: S, leaf: usize) -> f32 {
        self(leaf)
    }
}

impl NodeRay {
    #[inline]
    pub(crate) fn new(stretch: Stretch, direction: DVec3) -> Self {
        let turned = vector(direction).to_array().map(|d| {
            if d.abs() < MIN_COMPONENT {
                MIN_COMPONENT.copysign(d).recip()
            } else {
                d.recip()
            }
        });
        Self {
            origin: vector(stretch.origin).to_array(),
            turned,
            first: [0, 1, 2].map(|axis| 2 * axis + usize::from(turned[axis] < 0.0)),
            until: stretch.until,
        }
    }
}

impl Wide {
    /// Builds a tree from nodes with a given depth; the root is the first node.
    pub(crate) fn new(nodes: Vec<Node>, depth: usize) -> Self {
        // Each node leaves at most seven children on the stack.
        let memory = (WIDTH - 1) * depth + 1;
        Self { nodes, memory }
    }

    /// Visits the leaves whose boxes a ray meets, approximately front to back.
    #[inline(always)]
    pub(crate) fn along<S: Simd>(&self, simd: S, ray: &NodeRay, visit: impl Visit) {
        if self.memory <= STACK {
            self.remembering(simd, ray, &mut [Waiting::default(); STACK], visit);
        } else if self.memory <= 2 * STACK {
            self.remembering(simd, ray, &mut [Waiting::default(); 2 * STACK], visit);
        } else {
            let mut memory = vec![Waiting::default(); self.memory];
            self.remembering(simd, ray, &mut memory, visit);
        }
    }

    /// Checks whether `is_hit` returns true for any leaf whose box a ray meets. `waiting` is the
    /// memory of the search.
    #[inline(always)]
    pub(crate) fn any<S: Simd>(
        &self,
        simd: S,
        ray: &NodeRay,
        waiting: &mut Vec<u32>,
        mut is_hit: impl FnMut(usize) -> bool,
    ) -> bool {
        waiting.resize(self.memory, 0);
        let mut count = 0;
        let mut node = &self.nodes[0];
        loop {
            let (mut met, _) = node.meets(simd, ray, ray.until);
            while met != 0 {
                waiting[count] = node.children[met.trailing_zeros() as usize % WIDTH];
                count += 1;
                met &= met - 1;
            }
            node = loop {
                if count == 0 {
                    return false;
                }
                count -= 1;
                let child = waiting[count];
                if child & LEAF == 0 {
                    break &self.nodes[child as usize];
                }
                if is_hit((child ^ LEAF) as usize) {
                    return true;
                }
            };
        }
    }

    #[inline(always)]
    fn remembering<S: Simd>(
        &self,
        simd: S,
        ray: &NodeRay,
        waiting: &mut [Waiting],
        mut visit: impl Visit,
    ) {
        let mut until = ray.until;
        let mut count = 0;
        let mut node = &self.nodes[0];
        loop {
            let (mut met, near) = node.meets(simd, ray, until);
            let only = node.children[met.trailing_zeros() as usize % WIDTH];
            if met.is_power_of_two() && only & LEAF == 0 {
                node = &self.nodes[only as usize];
                continue;
            }
            // The children are sorted so that the nearest child is on top of the stack.
            let before = count;
            while met != 0 {
                let i = met.trailing_zeros() as usize % WIDTH;
                met &= met - 1;
                let mut place = count;
                while place > before && waiting[place - 1].near < near[i] {
                    waiting[place] = waiting[place - 1];
                    place -= 1;
                }
                let (near, child) = (near[i], node.children[i]);
                waiting[place] = Waiting { near, child };
                count += 1;
            }
            node = loop {
                if count == 0 {
                    return;
                }
                count -= 1;
                let Waiting { near, child } = waiting[count];
                if near > until {
                    continue;
                }
                if child & LEAF == 0 {
                    break &self.nodes[child as usize];
                }
                until = until.min(visit.visit(simd, (child ^ LEAF) as usize));
                if until < 0.0 {
                    return;
                }
            };
        }
    }
}

impl Node {
    pub(crate) const EMPTY: Self = {
        let [low, high] = [[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]];
        Self {
            planes: [low, high, low, high, low, high],
            children: [LEAF; WIDTH],
        }
    };

    pub(crate) fn inner(place: usize) -> u32 {
        // There are fewer nodes than boxes, and at most 2³² boxes.
        u32::try_from(place).unwrap_or(LEAF) & !LEAF
    }

    pub(crate) fn leaf(place: usize) -> u32 {
        Self::inner(place) | LEAF
    }

    /// Replaces the children of this node. `new` receives whether a child is a leaf, and its
    /// number.
    pub(crate) fn map_children(&mut self, new: impl Fn(bool, usize) -> u32) {
        for (i, child) in self.children.iter_mut().enumerate() {
            let is_filled = self.planes[0][i] <= self.planes[1][i];
            if is_filled {
                *child = new(*child & LEAF != 0, (*child & !LEAF) as usize);
            }
        }
    }

    /// Stores a child in one of the slots, with a box from its lowest to its highest corner.
    pub(crate) fn set(&mut self, place: usize, [low, high]: [[f32; 3]; 2], child: u32) {
        for axis in 0..3 {
            self.planes[2 * axis][place] = low[axis];
            self.planes[2 * axis + 1][place] = high[axis];
        }
        self.children[place] = child;
    }

    /// The boxes that a ray meets, as a mask with one bit for each box, and the distances
    /// at which the boxes begin.
    #[inline(always)]
    fn meets<S: Simd>(&self, simd: S, ray: &NodeRay, until: f32) -> (u32, [f32; WIDTH]) {
        let [x, y, z] = ray.first;
        let near = self.crossing(simd, ray, 0, x);
        let near = near.max(self.crossing(simd, ray, 1, y));
        let near = near.max(self.crossing(simd, ray, 2, z));
        let near = near.max(f32x8::splat(simd, 0.0));
        let far = self.crossing(simd, ray, 0, x ^ 1);
        let far = far.min(self.crossing(simd, ray, 1, y ^ 1));
        let far = far.min(self.crossing(simd, ray, 2, z ^ 1));
        let far = far.min(f32x8::splat(simd, until));
        let met = near.simd_le(far).to_bitmask();
        (u32::try_from(met).unwrap_or_default(), near.into())
    }

    /// The distances along the ray at which it crosses one side of each box.
    #[inline(always)]
    fn crossing<S: Simd>(&self, simd: S, ray: &NodeRay, axis: usize, plane: usize) -> f32x8<S> {
        let plane = f32x8::simd_from(simd, self.planes[plane]);
        (plane - ray.origin[axis]) * ray.turned[axis]
    }
}
