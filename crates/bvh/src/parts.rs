//! Builds a tree with eight boxes in a node from parts of a set of boxes, so that the binary tree
//! of all boxes is never in memory.

use crate::build::{TreeKind, built, in_parts, number};
use crate::collapse::{Collapsed, collapsed};
use crate::space::Space;
use crate::wide::{Node, Wide};
use glam::DVec3;
use obvhs::aabb::Aabb;
use rayon::prelude::*;

/// The maximum number of boxes that are built together.
const PART: usize = 1 << 14;

/// A lower bound on the usual number of boxes for each node, for the initial size of the list of
/// nodes. The operating system provides memory only when the program writes to the memory.
const BOXES_PER_NODE: usize = 4;

/// The tree over numbered boxes. Each leaf is the number of one box.
pub(crate) fn tree(
    count: usize,
    space: &Space,
    bounds: impl Fn(usize) -> [DVec3; 2] + Sync,
) -> Wide {
    let boxed = |i: &u32| space.padded(bounds(*i as usize));
    let order = in_parts(count, PART, space, &bounds);
    if count <= PART {
        let Collapsed { nodes, depth, .. } = part(&order, boxed);
        return Wide::new(nodes, depth);
    }
    let all = |part: &[u32]| {
        let boxes = part.iter().map(boxed);
        boxes.fold(Aabb::INVALID, |all, one| all.union(&one))
    };
    let roots: Vec<Aabb> = order.par_chunks(PART).map(all).collect();
    let numbers: Vec<u32> = (0..number(roots.len())).collect();
    let top = part(&numbers, |i| roots[*i as usize]);
    let mut places = Vec::new();
    let mut nodes = Vec::with_capacity(count / BOXES_PER_NODE);
    nodes.extend(top.nodes);
    let above = nodes.len();
    let mut depth = 0;
    for boxes in order.chunks(PART * rayon::current_num_threads()) {
        let built = boxes.par_chunks(PART).map(|boxes| part(boxes, boxed));
        for mut part in built.collect::<Vec<Collapsed>>() {
            let before = nodes.len();
            for node in &mut part.nodes {
                node.map_children(|is_leaf, i| match is_leaf {
                    true => Node::leaf(i),
                    false => Node::inner(before + i),
                });
            }
            places.push(before);
            nodes.append(&mut part.nodes);
            depth = depth.max(part.depth);
        }
    }
    for node in &mut nodes[..above] {
        node.map_children(|is_leaf, i| Node::inner(if is_leaf { places[i] } else { i }));
    }
    Wide::new(nodes, top.depth + depth)
}

/// The tree over some of the boxes.
fn part(numbers: &[u32], boxed: impl Fn(&u32) -> Aabb) -> Collapsed {
    let bvh = built(numbers.to_vec(), TreeKind::CollapsedSingle, boxed);
    let mut part = collapsed(&bvh);
    let of_leaf = |leaf: usize| bvh.primitive_indices[part.leaves[leaf][0] as usize];
    for node in &mut part.nodes {
        node.map_children(|is_leaf, i| match is_leaf {
            true => Node::leaf(of_leaf(i) as usize),
            false => Node::inner(i),
        });
    }
    part
}
