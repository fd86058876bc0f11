//! What a theory says of a light field.

use crate::geometry::Matrix;
use etendue_field::{Projection, Slices};

/// What theory says of a light field.
#[derive(Clone, Debug, PartialEq)]
pub struct Predicted {
    /// The slices of the windowed spectrum. Unit: W m⁻² sr⁻¹ · m², on a surface
    /// W m⁻² sr⁻¹ · m² rad².
    pub slices: Slices,
    /// Independent predictions of which they are the mean, none of them biased; empty for closed
    /// forms and rules.
    pub replicates: Vec<Slices>,
    /// ‖error‖/‖F‖: the standard error of the mean of the replicates, or what finer rules change.
    /// `None` for a closed form; infinite if no ray arrives.
    pub error: Option<f64>,
    /// ∫ L W if nothing stood in the way, what slices of a closed form are small or large against;
    /// zero for nets.
    pub unblocked: f64,
    /// The windowed light field integrated over y and v, as means over cells of (x, u).
    pub projection: Projection,
    /// Second central moments of the windowed light field, in the plane's coordinates; `None` for
    /// closed forms, and if no light arrives.
    pub covariance: Option<Matrix<4>>,
    /// The derivative of the slices by each of the parameters asked for, per unit of it.
    pub derivatives: Vec<Slices>,
    /// What the first-order chain of a reflection predicts, less the slices, over the same rays.
    pub to_first_order: Option<Slices>,
}
