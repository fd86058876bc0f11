//! Builds trees with two boxes in a node, by the crate obvhs.

use crate::leaf::MAX_LEAF;
use crate::space::Space;
use glam::DVec3;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use rayon::prelude::*;
use std::time::Duration;

/// The purpose for which a binary tree is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TreeKind {
    /// Rays traverse the binary tree directly.
    Binary,
    /// The binary tree is collapsed to a tree with eight boxes in a node, and several boxes in a
    /// leaf.
    Collapsed,
    /// The binary tree is collapsed to a tree with eight boxes in a node, and one box in a leaf.
    CollapsedSingle,
}

/// The maximum number of boxes that one thread builds; larger sets of boxes are built in parts of
/// this size. The builder needs about 150 bytes for each box, but only for the parts that are
/// being built.
const PART: usize = 1 << 15;

/// The largest number of boxes for which the tree is optimised by reinsertion. For this number of
/// boxes or fewer, reinsertion takes a tenth of a second and makes rays up to twice as fast. For
/// more boxes, reinsertion takes seconds and makes rays a few per cent faster.
const MAX_REINSERTED: usize = 1 << 13;

/// Cost of opening a node, in units of the cost of a triangle test. A leaf tests several triangles
/// at a time.
const OPENING: f32 = 3.0;

/// Builds the binary tree over indexed boxes, given by their lowest and highest corners.
pub(crate) fn bvh(
    count: usize,
    space: &Space,
    kind: TreeKind,
    bounds: impl Fn(usize) -> [DVec3; 2] + Sync,
) -> Bvh2 {
    let boxed = |i: &u32| space.padded(bounds(*i as usize));
    let order = in_parts(count, PART, space, &bounds);
    if count <= PART {
        return built(order, kind, boxed);
    }
    let part = |part: &[u32]| built(part.to_vec(), kind, boxed);
    let parts = order.par_chunks(PART).map(part).collect();
    drop(order);
    joined(parts, kind)
}

/// The numbers of boxes. If they are built in parts of `part` boxes, they are in the order
/// of a space-filling curve.
pub(crate) fn in_parts(
    count: usize,
    part: usize,
    space: &Space,
    bounds: &(impl Fn(usize) -> [DVec3; 2] + Sync),
) -> Vec<u32> {
    let numbers = 0..number(count);
    if count <= part {
        return numbers.collect();
    }
    let place = |i| (space.place(bounds(i as usize)), i);
    let mut order: Vec<(u64, u32)> = numbers.into_par_iter().map(place).collect();
    order.par_sort_unstable();
    order.into_iter().map(|(_, i)| i).collect()
}

/// Builds the tree over some of the boxes.
pub(crate) fn built(numbers: Vec<u32>, kind: TreeKind, boxed: impl Fn(&u32) -> Aabb) -> Bvh2 {
    let boxes: Vec<Aabb> = numbers.iter().map(boxed).collect();
    let preset = if boxes.len() <= MAX_REINSERTED {
        BvhBuildParams::very_slow_build()
    } else {
        BvhBuildParams::fast_build()
    };
    // Pre-splits are not used, because they apply only to triangles.
    let parameters = BvhBuildParams {
        pre_split: false,
        ..preset
    };
    let parameters = match kind {
        TreeKind::Binary => parameters,
        TreeKind::CollapsedSingle => BvhBuildParams {
            max_prims_per_leaf: 1,
            ..parameters
        },
        TreeKind::Collapsed => BvhBuildParams {
            max_prims_per_leaf: number(MAX_LEAF),
            collapse_traversal_cost: OPENING,
            ..parameters
        },
    };
    let mut bvh = build_bvh2(&boxes, parameters, &mut Duration::default());
    for i in &mut bvh.primitive_indices {
        *i = numbers[*i as usize];
    }
    finished(bvh, kind)
}

/// Finishes a tree for traversal: nodes are stored in the order in which they are opened.
fn finished(mut bvh: Bvh2, kind: TreeKind) -> Bvh2 {
    if kind == TreeKind::Binary {
        bvh.reorder_in_stack_traversal_order();
        bvh.parents = Vec::new();
        bvh.nodes.shrink_to_fit();
    }
    bvh
}

/// Joins several trees into one.
fn joined(mut parts: Vec<Bvh2>, kind: TreeKind) -> Bvh2 {
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
        // The root of a part replaces a leaf of the tree; the other nodes of the part are
        // appended.
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
    // The boxes of different parts overlap, so some nodes would be better elsewhere in the tree;
    // reinsertion moves these nodes.
    ReinsertionOptimizer::default().run(&mut bvh, 0.01, None);
    if kind == TreeKind::Binary {
        bvh.max_depth = bvh.max_depth.max(bvh.depth(0) + 1);
    }
    finished(bvh, kind)
}

pub(crate) fn number(count: usize) -> u32 {
    u32::try_from(count).unwrap_or(u32::MAX)
}
