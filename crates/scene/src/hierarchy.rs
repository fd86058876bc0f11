//! Which boxes a ray may meet: the only file that knows obvhs, and f32.
//!
//! The hierarchy, in f32, only names candidates; whether and where something is hit is decided in
//! f64 by who asks. Boxes are padded by more than rounding, so no candidate is missed.
//!
//! The builder panics on boxes that are no numbers. No legal scene has them, and none reach it:
//! what has no box in f32 is a candidate everywhere.

use glam::{DVec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::morton::morton_encode_u64_unorm;
use obvhs::ray::{Ray, RayHit};
use rayon::prelude::*;
use std::fmt;
use std::time::Duration;

/// A hierarchy over boxes.
#[derive(Clone)]
pub struct Hierarchy {
    bvh: Bvh2,
    space: Space,
}

/// Where boxes are: f32 counts from the middle of all of them.
#[derive(Clone, Copy, Debug)]
struct Space {
    center: DVec3,
    /// The largest coordinate from there.
    size: f64,
    /// By how much boxes grow.
    padding: f64,
}

/// Boxes grow by this share of `Space::size`: f32 rounding is 6e-8 of it, a ray adds a few of
/// those.
const PADDING: f64 = 1e-5;

/// And by this share of the largest coordinate that a ray begins at: some roundings of f64.
const ROUNDING: f64 = 1e-13;

/// The largest coordinate of a box, which f32 still holds four times over. The farthest corner of a
/// patch is at 1e28.
const MAX_EXTENT: f64 = 1e36;

/// More boxes than these are built in parts of as many, each by one thread. What the builder needs,
/// some 150 bytes for each box, is then held for a part at a time.
const PART: usize = 1 << 15;

/// Up to so many boxes the builder takes its time: a tenth of a second makes rays up to twice as
/// fast. With more it takes seconds, for a few percent.
const MAX_REINSERTED: usize = 1 << 13;

impl Hierarchy {
    /// Over boxes, by number, given by their lowest and highest corners. `origins` is the largest
    /// coordinate a ray starts from.
    #[must_use]
    pub fn new(count: usize, origins: f64, bounds: impl Fn(usize) -> [DVec3; 2] + Sync) -> Self {
        let space = Space::around((0..count).map(&bounds), origins);
        let boxed = |i: &u32| space.padded(bounds(*i as usize));
        let numbers = 0..number(count);
        if count <= PART {
            let bvh = built(numbers.collect(), boxed);
            return Self { bvh, space };
        }
        let place = |i| (space.place(bounds(i as usize)), i);
        let mut order: Vec<(u64, u32)> = numbers.into_par_iter().map(place).collect();
        order.par_sort_unstable();
        let part = |part: &[(u64, u32)]| built(part.iter().map(|(_, i)| *i).collect(), boxed);
        let parts = order.par_chunks(PART).map(part).collect();
        drop(order);
        let bvh = joined(parts);
        Self { bvh, space }
    }

    /// The boxes, in the order in which [`Self::along`] names them.
    #[must_use]
    pub fn order(&self) -> &[u32] {
        &self.bvh.primitive_indices
    }

    /// Names the boxes that a ray may meet from `from` on, the nearer ones about first. Distances
    /// are in lengths of `direction`, which is at least 1 long. `meet` tells how far boxes still
    /// matter; before anything is met, that is `until`.
    #[inline]
    pub fn along(
        &self,
        start: DVec3,
        direction: DVec3,
        [from, until]: [f64; 2],
        mut meet: impl FnMut(usize) -> f64,
    ) {
        let begin = self.space.begin(start, direction, from);
        let origin = start + begin * direction - self.space.center;
        // Boxes this far are still opened: what is met is decided in f64.
        let limit = |at: f64| single((at - begin) * (1.0 + PADDING) + self.space.padding);
        let ray = Ray::new(vector(origin), vector(direction), 0.0, limit(until));
        let meet = |_: &Ray, i| limit(meet(i));
        self.bvh.ray_traverse(ray, &mut RayHit::none(), meet);
    }
}

impl Space {
    fn around(boxes: impl Iterator<Item = [DVec3; 2]>, origins: f64) -> Self {
        let sound = boxes.filter(|of| is_sound(of, MAX_EXTENT));
        let all = sound.reduce(|[a, b], [low, high]| [a.min(low), b.max(high)]);
        let [low, high] = all.unwrap_or_default();
        let center = 0.5 * low + 0.5 * high;
        let size = (high - center).max(center - low).max_element();
        let farthest = (center.abs().max_element() + size + origins).min(MAX_EXTENT);
        Self {
            center,
            size,
            padding: PADDING * size + ROUNDING * farthest,
        }
    }

    /// The box to look for.
    fn padded(&self, [low, high]: [DVec3; 2]) -> Aabb {
        let (low, high) = (
            low - self.center - self.padding,
            high - self.center + self.padding,
        );
        if is_sound(&[low, high], 2.0 * MAX_EXTENT) {
            Aabb::new(vector(low), vector(high))
        } else {
            let everywhere = DVec3::splat(self.size + self.padding);
            Aabb::new(vector(-everywhere), vector(everywhere))
        }
    }

    /// Where the middle of a box is on a curve that fills the space.
    fn place(&self, [low, high]: [DVec3; 2]) -> u64 {
        let middle = 0.5 * (low + high) - self.center;
        // From 0 to below 1.
        morton_encode_u64_unorm(0.5 + 0.49 * middle / self.size)
    }

    /// Where to begin looking along a ray: at `from`, or, if that is far from everything, where it
    /// comes near; f32 would lose it on the way.
    #[inline]
    fn begin(&self, start: DVec3, direction: DVec3, from: f64) -> f64 {
        let start = start - self.center;
        let at = start + from * direction;
        if at.abs().max_element() < 4.0 * self.size {
            return from;
        }
        let comes_near = |at: f64, d: f64| (-at - (2.0 * self.size).copysign(d)) / d;
        let near = [0, 1, 2].map(|axis| comes_near(start[axis], direction[axis]));
        // Along an axis a ray does not come nearer: NaN, or beyond all numbers.
        let near = near.into_iter().filter(|t| t.is_finite());
        near.fold(from, f64::max)
    }
}

impl fmt::Debug for Hierarchy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Hierarchy")
            .field("boxes", &self.order().len())
            .finish_non_exhaustive()
    }
}

fn is_sound(corners: &[DVec3; 2], largest: f64) -> bool {
    let within = |p: &DVec3| p.is_finite() && p.abs().max_element() <= largest;
    corners.iter().all(within)
}

/// The hierarchy over some boxes.
fn built(numbers: Vec<u32>, boxed: impl Fn(&u32) -> Aabb) -> Bvh2 {
    let boxes: Vec<Aabb> = numbers.iter().map(boxed).collect();
    let preset = if boxes.len() <= MAX_REINSERTED {
        BvhBuildParams::very_slow_build()
    } else {
        BvhBuildParams::fast_build()
    };
    // Without pre-splits: they are for triangles.
    let parameters = BvhBuildParams {
        pre_split: false,
        ..preset
    };
    let mut bvh = build_bvh2(&boxes, parameters, &mut Duration::default());
    for i in &mut bvh.primitive_indices {
        *i = numbers[*i as usize];
    }
    finished(bvh)
}

/// A hierarchy as rays ask it: nodes lie in the order in which they are opened.
fn finished(mut bvh: Bvh2) -> Bvh2 {
    bvh.reorder_in_stack_traversal_order();
    bvh.parents = Vec::new();
    bvh.nodes.shrink_to_fit();
    bvh
}

/// One hierarchy over what several have.
fn joined(mut parts: Vec<Bvh2>) -> Bvh2 {
    let root = |i: &u32| *parts[*i as usize].nodes[0].aabb();
    let one_each = BvhBuildParams {
        max_prims_per_leaf: 1,
        ..BvhBuildParams::very_slow_build()
    };
    let numbers: Vec<u32> = (0..).take(parts.len()).collect();
    let roots: Vec<Aabb> = numbers.iter().map(root).collect();
    let mut bvh = build_bvh2(&roots, one_each, &mut Duration::default());
    let of_parts = std::mem::take(&mut bvh.primitive_indices);
    let above = bvh.nodes.len();
    let below = |counted: fn(&Bvh2) -> usize| parts.iter().map(counted).sum::<usize>();
    bvh.nodes.reserve_exact(below(|part| part.nodes.len() - 1));
    bvh.primitive_indices
        .reserve_exact(below(|part| part.primitive_indices.len()));
    for leaf in 0..above {
        if !bvh.nodes[leaf].is_leaf() {
            continue;
        }
        let part = of_parts[bvh.nodes[leaf].first_index as usize] as usize;
        let part = std::mem::take(&mut parts[part]);
        // The root takes the place of the leaf, what is below it comes after all else.
        let [nodes, boxes] = [bvh.nodes.len() - 1, bvh.primitive_indices.len()].map(number);
        let mut moved = part.nodes.iter().map(|node| {
            let by = if node.is_leaf() { boxes } else { nodes };
            Bvh2Node {
                first_index: node.first_index + by,
                ..*node
            }
        });
        if let Some(root) = moved.next() {
            bvh.nodes[leaf] = root;
        }
        bvh.nodes.extend(moved);
        bvh.primitive_indices.extend(&part.primitive_indices);
    }
    bvh.parents = Vec::new();
    // Parts overlap: some nodes belong elsewhere.
    ReinsertionOptimizer::default().run(&mut bvh, 0.01, None);
    bvh.max_depth = bvh.max_depth.max(bvh.depth(0) + 1);
    finished(bvh)
}

fn number(count: usize) -> u32 {
    u32::try_from(count).unwrap_or(u32::MAX)
}

#[inline]
fn vector(v: DVec3) -> Vec3A {
    Vec3A::new(single(v.x), single(v.y), single(v.z))
}

#[inline]
#[expect(
    clippy::cast_possible_truncation,
    reason = "f32 only names candidates; padding covers its rounding"
)]
fn single(x: f64) -> f32 {
    x as f32
}
