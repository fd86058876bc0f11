//! What every theory answers.

use crate::nets::{RayBudget, RayNets};
use crate::parameter::{New, Parameter};
use crate::plane::Plane;
use crate::predicted::Predicted;
use crate::work::PredictionWork;
use etendue_field::{Light, ProjectionGrid, SliceGrid, Window};

/// What a prediction is over: a window, frequencies and the cells of a picture.
pub type Over<'a> = (&'a Window, &'a SliceGrid, &'a ProjectionGrid);

/// Whatever predicts the light field at a plane.
pub trait Model: Clone {
    /// What shines.
    fn light(&self) -> &Light;

    /// The numbers that a measurement may be asked for, in the order light meets them.
    fn parameters(&self) -> Vec<Parameter>;

    /// One of them in words, e.g. "travel light to blockers".
    fn name(&self, parameter: Parameter) -> String;

    /// Puts `new(value)` in the place of the value of a parameter. `None` if the model does not
    /// have it, or its central ray does not arrive.
    fn change(&mut self, parameter: Parameter, new: New<'_>) -> Option<()>;

    /// The slices with their error, a picture, and the derivatives by some of its parameters.
    fn predict(&self, parameters: &[Parameter], over: Over<'_>, budget: RayBudget) -> Predicted;

    /// Calls `then` with the light field as nets of rays, drawn as [`predict`](Self::predict) draws them. It
    /// is not called where no ray arrives.
    fn with_rays(&self, over: Over<'_>, budget: RayBudget, then: &mut dyn FnMut(&dyn RayNets));

    /// What a prediction takes.
    fn work(&self, over: Over<'_>, budget: RayBudget) -> PredictionWork;

    /// The unit of a parameter; empty if it is a pure number.
    fn unit(&self, parameter: Parameter) -> &'static str {
        parameter.unit(self.light())
    }

    /// Its value, in its unit. `None` as for [`change`](Self::change).
    fn value(&self, parameter: Parameter) -> Option<f64> {
        let mut value = None;
        self.clone().change(parameter, &mut |current| {
            value = Some(current);
            current
        })?;
        value
    }

    /// The same with another value of a parameter, in its unit. `None` as for
    /// [`change`](Self::change).
    fn with(&self, parameter: Parameter, value: f64) -> Option<Self> {
        let mut other = self.clone();
        other.change(parameter, &mut |_| value)?;
        Some(other)
    }
}

/// A system of surfaces, and the plane at which its light is looked at.
#[derive(Clone, Debug, PartialEq)]
pub struct Observed<S> {
    /// The light, and what it meets.
    pub system: S,
    /// Where it is looked at.
    pub plane: Plane,
}

/// A model with a little more and a little less of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ShiftedModels<M> {
    /// How far apart the values are, in the parameter's unit.
    pub(crate) apart: f64,
    /// With more, and with less.
    pub(crate) sides: [M; 2],
}

/// Step of a derivative, as a share of the parameter's scale.
const STEP: f64 = 1e-3;

impl<M: Model> ShiftedModels<M> {
    /// A model moved by a small step to both sides.
    pub(crate) fn nearby(model: &M, parameter: Parameter) -> Option<Self> {
        let step = STEP * parameter.scale(model.value(parameter)?);
        Self::new(model, parameter, step, |moved| moved)
    }
}

impl<M> ShiftedModels<M> {
    /// A model moved by a step to both sides, each made into another.
    pub(crate) fn new<A: Model>(
        model: &A,
        parameter: Parameter,
        step: f64,
        into: impl Fn(A) -> M,
    ) -> Option<Self> {
        let value = model.value(parameter)?;
        let at = |value| Some(into(model.with(parameter, value)?));
        Some(Self {
            apart: 2.0 * step,
            sides: [at(value + step)?, at(value - step)?],
        })
    }
}
