use crate::chain::chain;
use etendue_field::{Projection, ProjectionGrid, Slices, VirtualPlane};
use etendue_scene::Scene;
use etendue_spectrum::PROJECTION_BINS;
use etendue_theory::{Chain, Operator};
use serde::Serialize;

/// What kind of prediction a plane has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Class {
    /// Equals the expectation of the measurement, in closed form.
    Exact,
}

/// Everything theory says about a plane.
#[derive(Clone, Debug)]
pub struct Prediction {
    /// What kind it is.
    pub class: Class,
    /// The chain it comes from.
    pub chain: Chain,
    /// The slices of the windowed spectrum.
    pub slices: Slices,
    /// ∫ L W if nothing stood in the way: what the slices are small or large against.
    pub unblocked: f64,
    /// The windowed light field in (x, u).
    pub projection: Projection,
    /// For each parameter of the chain: name, value and derivative of the slices.
    pub parameters: Vec<PredictedParameter>,
}

/// A parameter of the chain and how the slices depend on it.
#[derive(Clone, Debug)]
pub struct PredictedParameter {
    /// Name, such as "travel light to blockers".
    pub name: String,
    /// Value in the scene.
    pub value: f64,
    /// ∂ slices / ∂ parameter.
    pub derivative: Slices,
}

impl Prediction {
    /// Predicts a plane of a scene.
    #[must_use]
    pub fn new(scene: &Scene, plane: &VirtualPlane) -> Self {
        let chain = chain(scene, plane);
        let slices = etendue_theory::slices(&chain, &plane.window, &plane.grid);
        let grid = ProjectionGrid::new(&plane.window, PROJECTION_BINS);
        let parameters = chain
            .parameters()
            .into_iter()
            .map(|parameter| PredictedParameter {
                name: chain.name(parameter),
                value: chain.value(parameter),
                derivative: etendue_theory::derivative(
                    &chain,
                    parameter,
                    &plane.window,
                    &plane.grid,
                    &slices,
                ),
            })
            .collect();
        let mut open = chain.clone();
        open.operators
            .retain(|o| matches!(o, Operator::Travel { .. }));
        Self {
            class: Class::Exact,
            unblocked: etendue_theory::at(&open, &plane.window, [0.0; 4]).re,
            projection: etendue_theory::projection(&chain, &plane.window, &grid),
            chain,
            slices,
            parameters,
        }
    }
}
