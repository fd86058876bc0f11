use crate::chain::chain;
use etendue_field::{Projection, ProjectionGrid, Slices, VirtualPlane, Window};
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

impl Class {
    /// The kind of prediction a chain has. Travel and visibility in planes have closed forms: it is exact.
    #[must_use]
    pub fn of(chain: &Chain) -> Self {
        // A new operator must say here what it does to the class.
        chain
            .operators
            .iter()
            .fold(Self::Exact, |class, operator| match operator {
                Operator::Travel { .. } | Operator::Visibility { .. } => class,
            })
    }
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

/// The steps that make the spectrum of a plane, a line for each: the chain, and the window last.
#[must_use]
pub fn steps(chain: &Chain, window: &Window) -> Vec<String> {
    let Window { x, y, u, v } = window;
    let mut steps = chain.describe();
    steps.push(format!(
        "multiply  window: x {x:?}, y {y:?}, u {u:?}, v {v:?}"
    ));
    steps
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
            class: Class::of(&chain),
            unblocked: etendue_theory::at(&open, &plane.window, [0.0; 4]).re,
            projection: etendue_theory::projection(&chain, &plane.window, &grid),
            chain,
            slices,
            parameters,
        }
    }
}
