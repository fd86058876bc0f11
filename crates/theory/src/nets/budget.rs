//! The work that a prediction may take.

use etendue_field::whole;

/// The criterion by which a prediction stops adding nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayBudget {
    /// Maximum number of nodes of all nets together. If this budget ends the prediction, at least
    /// half of these nodes have been used.
    pub nodes: f64,
    /// The relative error ‖error‖/‖F‖ below which no more nodes are added.
    pub error: f64,
    /// The norm of the light of other sources at the same plane. If it exceeds ‖F‖, `error` is
    /// relative to it.
    pub beside: f64,
    /// Number of computing steps that a closed form or a quadrature may take in any case. If it
    /// needs more steps, nets replace it where they take far fewer. A core takes about a nanosecond
    /// for each step.
    pub steps: f64,
}

/// Default of [`RayBudget::steps`] for a closed form or a quadrature. These steps take
/// about ten seconds on one core. In the same time, nets of rays would give a prediction with more
/// noise than the photons, so a closed form is preferred up to this limit.
const MAX_STEPS: f64 = 1e10;

impl RayBudget {
    /// The budget for the only light of a scene with one plane, from the maximum number of
    /// nodes and the relative error.
    #[must_use]
    pub const fn new(nodes: f64, error: f64) -> Self {
        Self {
            nodes,
            error,
            beside: 0.0,
            steps: MAX_STEPS,
        }
    }

    /// This budget for one of several equal parts of the work whose errors are independent.
    #[must_use]
    pub fn shared(self, parts: usize) -> Self {
        let parts = parts as f64;
        Self {
            nodes: self.nodes / parts,
            error: self.error / parts.sqrt(),
            steps: self.steps / parts,
            ..self
        }
    }
}

/// Number of independent nets for derivatives. Their spread gives the noise of each.
pub(super) const OF_DERIVATIVES: usize = 8;
/// Minimum and maximum number of nodes in each net by which derivatives are computed.
pub(super) const DERIVATIVE_NODES: [u32; 2] = [1 << 11, 1 << 15];
/// Maximum number of nodes for derivatives, times the number of parameters, as a multiple of the
/// nodes of the prediction. Each node has two rays for each parameter.
const FOR_DERIVATIVES: f64 = 2.0;

/// How many derivatives a budget of rays includes, if they take half of the nodes that
/// derivatives may take. With fewer nodes for each, the noise of derivatives would make stated
/// errors of parameters too small.
pub(crate) fn affordable_derivatives(budget: RayBudget) -> usize {
    let each = OF_DERIVATIVES as f64 * f64::from(DERIVATIVE_NODES[0]);
    whole(0.5 * FOR_DERIVATIVES * budget.nodes / each)
}

/// The maximum number of nodes in each net for derivatives.
pub(super) fn most_for_derivatives(fields: usize, nodes: f64) -> u32 {
    let all = FOR_DERIVATIVES * nodes / fields as f64;
    power_of_two(all / OF_DERIVATIVES as f64, DERIVATIVE_NODES)
}

/// The largest power of two that is at most `count` and within a range of powers of two.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the number is within the range"
)]
pub(super) fn power_of_two(count: f64, [least, most]: [u32; 2]) -> u32 {
    1 << (count.clamp(f64::from(least), f64::from(most)) as u32).ilog2()
}
