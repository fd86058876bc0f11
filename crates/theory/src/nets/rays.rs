//! Access to the individual rays of nets. With it, other sums over rays than the slices of a
//! spectrum can be computed.

use super::{DIMENSIONS, Integrand, NetPoints, REPLICATES, RayBudget, RayNode, power_of_two};
use etendue_field::TwoPlane;

/// A light field at a plane as weighted rays in independent nets. Each net represents the complete
/// light field.
pub trait RayNets: Sync {
    /// The number of nets. A single net has no statistical error.
    fn count(&self) -> usize;

    /// Calls `each` with the rays of a net and their contributions to the windowed radiance space.
    fn emit(&self, net: usize, each: &mut dyn FnMut(&TwoPlane, f64));
}

/// The nets over which [`sums`](super::sums) sums the first field; all nets have the same number
/// of nodes.
pub(crate) struct SampledNets<'a, I> {
    integrand: &'a I,
    nodes: u32,
}

/// Maximum number of nodes of a net.
const MAX_NODES: u32 = 1 << 29;

impl<'a, I: Integrand> SampledNets<'a, I> {
    /// The number of nodes per net: the largest power of two that a budget allows.
    pub(crate) fn new(integrand: &'a I, budget: RayBudget) -> Self {
        let nodes = power_of_two(budget.nodes / REPLICATES as f64, [1, MAX_NODES]);
        Self { integrand, nodes }
    }
}

impl<I: Integrand> RayNets for SampledNets<'_, I> {
    fn count(&self) -> usize {
        REPLICATES
    }

    #[expect(clippy::cast_possible_truncation, reason = "below REPLICATES")]
    fn emit(&self, net: usize, each: &mut dyn FnMut(&TwoPlane, f64)) {
        let mut net = NetPoints::new(net as u32, self.integrand.dimensions());
        let share = 1.0 / f64::from(self.nodes);
        let wanted = vec![true; self.integrand.fields()];
        let mut nodes = vec![RayNode::DARK; wanted.len() * self.integrand.rays()];
        for _ in 0..self.nodes {
            nodes.fill(RayNode::DARK);
            let at: [f64; DIMENSIONS] = net.point();
            self.integrand.nodes(&at, &wanted, &mut nodes);
            let of_first = nodes.iter().take(self.integrand.rays());
            for RayNode { z, weight } in of_first.filter(|node| node.weight != 0.0) {
                let [x, y, u, v] = *z;
                each(&TwoPlane { x, y, u, v }, share * weight);
            }
        }
    }
}
