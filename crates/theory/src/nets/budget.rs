//! The work that a prediction may take.

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
    /// Returns the budget for the only light of a scene with one plane, from the maximum number of
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

    /// Returns this budget for one of several equal parts of the work whose errors are independent.
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
