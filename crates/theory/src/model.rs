//! The trait that all models for predictions implement.

use crate::nets::{RayBudget, RayNets};
use crate::parameter::{New, Parameter};
use crate::predicted::Predicted;
use crate::work::PredictionWork;
use etendue_field::{Light, ProjectionGrid, SliceGrid, Window};

/// The domain of a prediction: a window, the frequencies of slices, and the cells of a picture.
pub type Over<'a> = (&'a Window, &'a SliceGrid, &'a ProjectionGrid);

/// A model that predicts the light field at a plane.
pub trait Model: Clone {
    /// The light source.
    fn light(&self) -> &Light;

    /// The parameters that can be estimated from a measurement, in the order of
    /// propagation.
    fn parameters(&self) -> Vec<Parameter>;

    /// Leaves out parameters whose derivatives would take too long, beginning with the last.
    fn keep_affordable(&self, _parameters: &mut Vec<Parameter>, _budget: RayBudget) {}

    /// The readable name of a parameter, e.g. "travel light to blockers".
    fn name(&self, parameter: Parameter) -> String;

    /// Replaces the value of a parameter by `new(value)`. Returns `None` if the model does not have
    /// the parameter, or if the central ray does not arrive.
    fn change(&mut self, parameter: Parameter, new: New<'_>) -> Option<()>;

    /// Predicts the slices, their error, a picture, and the derivatives of the slices with respect
    /// to the given parameters.
    fn predict(&self, parameters: &[Parameter], over: Over<'_>, budget: RayBudget) -> Predicted;

    /// Calls `then` with the light field as nets of rays, which are sampled in the same way as in
    /// [`predict`](Self::predict). Does not call `then` if no ray arrives.
    fn with_rays(&self, over: Over<'_>, budget: RayBudget, then: &mut dyn FnMut(&dyn RayNets));

    /// Estimates the work of a prediction.
    fn work(&self, over: Over<'_>, budget: RayBudget) -> PredictionWork;

    /// The unit of a parameter, or an empty string for a dimensionless parameter.
    fn unit(&self, parameter: Parameter) -> &'static str {
        parameter.unit(self.light())
    }

    /// The value of a parameter, in its unit. Returns `None` as for
    /// [`change`](Self::change).
    fn value(&self, parameter: Parameter) -> Option<f64> {
        let mut value = None;
        self.clone().change(parameter, &mut |current| {
            value = Some(current);
            current
        })?;
        value
    }

    /// The model with another value of a parameter, in its unit. Returns `None` as for
    /// [`change`](Self::change).
    fn with(&self, parameter: Parameter, value: f64) -> Option<Self> {
        let mut other = self.clone();
        other.change(parameter, &mut |_| value)?;
        Some(other)
    }

    /// The step of a finite difference: `relative` times the scale of the parameter, but not
    /// so large that the phases of the highest frequencies change by more than `turns` turns.
    fn step(
        &self,
        parameter: Parameter,
        (window, grid): (&Window, &SliceGrid),
        [relative, turns]: [f64; 2],
    ) -> Option<f64> {
        let half_width = window.x.half_width();
        let most = match self.unit(parameter) {
            "m" => turns / grid.rho.max().max(1.0 / half_width),
            "1/m" => turns / half_width,
            _ => f64::INFINITY,
        };
        Some((relative * parameter.scale(self.value(parameter)?)).min(most))
    }
}

/// A model with a parameter slightly increased and slightly decreased.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ShiftedModels<M> {
    /// The increased value of the parameter minus the decreased value, in the parameter's unit.
    pub(crate) apart: f64,
    /// The models with the increased and with the decreased value of the parameter.
    pub(crate) sides: [M; 2],
    /// Whether the parameter belongs to a mask, so that it moves no ray.
    pub(crate) moves_mask: bool,
}

/// The step of a finite-difference derivative, as a fraction of the parameter's scale.
const STEP: f64 = 1e-3;

/// The step of a parameter of an edge in [`Model::step`], if rays are followed. It is large enough
/// for some rays to cross the edge of a shadow that moves, and small enough to change phases by at
/// most a third of a radian.
pub(crate) const STEPS_OF_EDGES: [f64; 2] = [5e-2, 0.05];

/// The largest number of halvings of a step. Smaller steps of an edge would leave few rays between
/// its positions.
const MAX_HALVINGS: usize = 10;

impl<M: Model> ShiftedModels<M> {
    /// The models with a parameter increased and decreased by a small step.
    pub(crate) fn nearby(model: &M, parameter: Parameter) -> Option<Self> {
        let step = STEP * parameter.scale(model.value(parameter)?);
        Self::new(model, parameter, step, |moved| moved)
    }
}

impl<M> ShiftedModels<M> {
    /// Builds the models with a parameter increased and decreased by a step, and converts both
    /// models by `into`. The step is halved until both models exist: for example, a corner may move
    /// only until the polygon is no longer convex.
    pub(crate) fn new<A: Model>(
        model: &A,
        parameter: Parameter,
        step: f64,
        into: impl Fn(A) -> M,
    ) -> Option<Self> {
        let value = model.value(parameter)?;
        let at = |value| Some(into(model.with(parameter, value)?));
        let halved = std::iter::successors(Some(step), |step| Some(0.5 * step));
        halved.take(MAX_HALVINGS).find_map(|step| {
            Some(Self {
                apart: 2.0 * step,
                sides: [at(value + step)?, at(value - step)?],
                moves_mask: parameter.mask().is_some(),
            })
        })
    }
}
