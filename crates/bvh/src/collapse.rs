//! Converts a binary tree to a tree with eight boxes in a node, such that a ray opens as few nodes
//! as possible.

use crate::leaf::MAX_LEAF;
use crate::wide::{Node, WIDTH};
use obvhs::bvh2::Bvh2;

/// Cost of visiting a leaf, in openings of a node.
const VISIT: f32 = 1.5;

/// The parts of an eight-wide tree.
pub(crate) struct Collapsed {
    /// The nodes; the root is the first node.
    pub(crate) nodes: Vec<Node>,
    /// The first box and the number of boxes of each leaf.
    pub(crate) leaves: Vec<[u32; 2]>,
    pub(crate) depth: usize,
}

/// The parts of the eight-wide tree made from a binary tree.
///
/// # Panics
///
/// Panics if a leaf has more than [`MAX_LEAF`] boxes.
pub(crate) fn collapsed(bvh: &Bvh2) -> Collapsed {
    // Usually, a tenth of the binary tree's nodes become nodes.
    let mut nodes = Vec::with_capacity(bvh.nodes.len() / 8 + 1);
    let mut leaves = Vec::with_capacity(bvh.nodes.len() / 2 + 1);
    nodes.push(Node::EMPTY);
    let mut deepest = 0;
    // Nodes of the binary tree, with their positions and depths.
    let mut todo: Vec<(usize, usize, usize)> = Vec::new();
    if !bvh.nodes.is_empty() {
        todo.push((0, 0, 1));
    }
    let costs = costs(bvh);
    let mut children = Vec::with_capacity(WIDTH);
    while let Some((root, place, depth)) = todo.pop() {
        deepest = deepest.max(depth);
        if bvh.nodes[root].is_leaf() {
            children.push(root);
        } else {
            share(bvh, &costs, root, WIDTH, &mut children);
        }
        for (i, child) in children.drain(..).enumerate() {
            let of = &bvh.nodes[child];
            let number = if of.is_leaf() {
                assert!(
                    of.prim_count as usize <= MAX_LEAF,
                    "a leaf has more than {MAX_LEAF} boxes"
                );
                leaves.push([of.first_index, of.prim_count]);
                Node::leaf(leaves.len() - 1)
            } else {
                todo.push((child, nodes.len(), depth + 1));
                nodes.push(Node::EMPTY);
                Node::inner(nodes.len() - 1)
            };
            nodes[place].set(i, [of.min.to_array(), of.max.to_array()], number);
        }
    }
    Collapsed {
        nodes,
        leaves,
        depth: deepest,
    }
}

/// The cost of rays below each node of the binary tree, if this node becomes at most 1, 2
/// … boxes of an eight-wide node. A cost is a sum of areas times the cost of opening (Ylitie,
/// Karras and Laine 2017, *Efficient incoherent ray traversal on GPUs through compressed wide
/// BVHs*, section 3.1).
fn costs(bvh: &Bvh2) -> Vec<[f32; WIDTH]> {
    let mut costs = vec![[0.0; WIDTH]; bvh.nodes.len()];
    let mut order = Vec::with_capacity(bvh.nodes.len());
    let mut todo: Vec<u32> = Vec::new();
    if !bvh.nodes.is_empty() {
        todo.push(0);
    }
    while let Some(node) = todo.pop() {
        order.push(node);
        let of = &bvh.nodes[node as usize];
        if !of.is_leaf() {
            todo.extend([of.first_index, of.first_index + 1]);
        }
    }
    // Children are processed before their parents.
    for node in order.into_iter().rev() {
        let node = node as usize;
        let of = &bvh.nodes[node];
        let area = of.aabb().half_area();
        if of.is_leaf() {
            costs[node] = [VISIT * area; WIDTH];
            continue;
        }
        let first = of.first_index as usize;
        let both = [costs[first], costs[first + 1]];
        let mut own = [area + shared(&both, WIDTH).1; WIDTH];
        for boxes in 2..=WIDTH {
            own[boxes - 1] = shared(&both, boxes).1.min(own[boxes - 2]);
        }
        costs[node] = own;
    }
    costs
}

/// Divides `boxes` between two children such that the total cost is smallest. Returns the number of
/// boxes of the first child, and this cost.
fn shared([first, second]: &[[f32; WIDTH]; 2], boxes: usize) -> (usize, f32) {
    let cost = |of_first: usize| first[of_first - 1] + second[boxes - of_first - 1];
    let mut best = (1, cost(1));
    for of_first in 2..boxes {
        if cost(of_first) < best.1 {
            best = (of_first, cost(of_first));
        }
    }
    best
}

/// Adds the nodes below `node` that become at most `boxes` boxes of an eight-wide node. The
/// [`costs`] decide which nodes become boxes.
fn share(bvh: &Bvh2, costs: &[[f32; WIDTH]], node: usize, boxes: usize, children: &mut Vec<usize>) {
    let first = bvh.nodes[node].first_index as usize;
    let (of_first, _) = shared(&[costs[first], costs[first + 1]], boxes);
    for (child, mut boxes) in [(first, of_first), (first + 1, boxes - of_first)] {
        let own = &costs[child];
        // At equal cost, fewer boxes are used.
        while boxes > 1 && own[boxes - 1] >= own[boxes - 2] {
            boxes -= 1;
        }
        if boxes == 1 {
            children.push(child);
        } else {
            share(bvh, costs, child, boxes, children);
        }
    }
}
