//! Builds a tree with eight boxes in a node from parts of a set of boxes, so that the binary tree of
//! all boxes is never in memory.

use crate::build::{PART, TreeKind, built, number};
use crate::collapse::{Collapsed, collapsed_parts};
use crate::space::Space;
use crate::wide::Wide;
use glam::DVec3;
use obvhs::aabb::Aabb;
use rayon::prelude::*;

/// The expected number of boxes for each node, for the initial size of the list of nodes.
const BOXES_PER_NODE: usize = 5;

/// Returns the tree over indexed boxes, and the boxes in the order of its leaves. Each leaf is a
/// single box.
pub(crate) fn tree(
    count: usize,
    space: &Space,
    bounds: impl Fn(usize) -> [DVec3; 2] + Sync,
) -> (Wide, Vec<u32>) {
    let boxed = |i: &u32| space.padded(bounds(*i as usize));
    let mut order = in_space(count, space, &bounds);
    if count <= PART {
        let Collapsed { nodes, depth, .. } = part(&mut order, boxed);
        return (Wide::new(nodes, depth), order);
    }
    let all = |part: &[u32]| {
        let boxes = part.iter().map(boxed);
        boxes.fold(Aabb::INVALID, |all, one| all.union(&one))
    };
    let roots: Vec<Aabb> = order.par_chunks(PART).map(all).collect();
    let mut above = (0..number(roots.len())).collect::<Vec<u32>>();
    let top = part(&mut above, |i| roots[*i as usize]);
    let mut places = vec![0; roots.len()];
    let mut nodes = Vec::with_capacity(count / BOXES_PER_NODE);
    nodes.extend(top.nodes);
    let above_nodes = nodes.len();
    let mut depth = 0;
    let at_once = PART * rayon::current_num_threads();
    for (group, boxes) in order.chunks_mut(at_once).enumerate() {
        let built = boxes.par_chunks_mut(PART).map(|boxes| part(boxes, boxed));
        let built: Vec<Collapsed> = built.collect();
        for (i, part) in built.into_iter().enumerate() {
            let i = group * at_once / PART + i;
            places[i] = nodes.len();
            let by = [nodes.len(), i * PART].map(number);
            nodes.extend(part.nodes.into_iter().map(|node| node.moved(by[0], by[1])));
            depth = depth.max(part.depth);
        }
    }
    for node in &mut nodes[..above_nodes] {
        *node = node
            .clone()
            .with_nodes_below(|leaf| places[above[leaf] as usize]);
    }
    nodes.shrink_to_fit();
    (Wide::new(nodes, top.depth + depth), order)
}

/// Returns the numbers of boxes; if they are built in parts, in the order of a space-filling curve.
fn in_space(
    count: usize,
    space: &Space,
    bounds: &(impl Fn(usize) -> [DVec3; 2] + Sync),
) -> Vec<u32> {
    let numbers = 0..number(count);
    if count <= PART {
        return numbers.collect();
    }
    let place = |i| (space.place(bounds(i as usize)), i);
    let mut order: Vec<(u64, u32)> = numbers.into_par_iter().map(place).collect();
    order.par_sort_unstable();
    order.into_iter().map(|(_, i)| i).collect()
}

/// Returns the tree over some of the boxes, and sorts their numbers in the order of its leaves.
fn part(numbers: &mut [u32], boxed: impl Fn(&u32) -> Aabb) -> Collapsed {
    let bvh = built(numbers.to_vec(), TreeKind::CollapsedSingle, boxed);
    let collapsed = collapsed_parts(&bvh);
    for (number, [first, _]) in numbers.iter_mut().zip(&collapsed.leaves) {
        *number = bvh.primitive_indices[*first as usize];
    }
    collapsed
}
