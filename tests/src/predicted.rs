//! Slices predicted by theory, with or without a planted modification.

use crate::scenes::compared;
use etendue_compare::{FirstOrder, FirstOrderChain, FirstOrderReport, Prediction};
use etendue_field::{ProjectionGrid, SliceGrid, Slices, VirtualPlane, Window};
use etendue_scene::Scene;
use etendue_spectrum::Measurement;
use etendue_theory::geometry::SpectrumMap;
use etendue_theory::path::{PathChain, rays, scattering};
use etendue_theory::{Model, Observed, Predicted, RayBudget};

/// Budget of rays. With this budget, the error of a prediction is a fifth of the noise of the
/// photons.
const BUDGET: RayBudget = RayBudget::new(5e6, 5e-4);

/// Predicts the slices behind specular surfaces by rays.
pub(crate) fn traced(view: &Observed, window: &Window, grid: &SliceGrid) -> Predicted {
    let picture = ProjectionGrid::new(window, 1);
    view.predict(&[], (window, grid, &picture), BUDGET)
}

/// Predicts the slices behind specular surfaces by a chain.
pub(crate) fn linear(
    view: &Observed,
    window: &Window,
    grid: &SliceGrid,
    map: &SpectrumMap<4>,
) -> Slices {
    let picture = ProjectionGrid::new(window, 1);
    rays::linear(view, (window, grid, &picture), map, BUDGET).slices
}

/// Predicts the slices behind a surface with a BRDF, both exactly and by a first-order chain.
pub(crate) fn scattered(view: &Observed, plane: &VirtualPlane, chain: &PathChain) -> [Slices; 2] {
    let picture = ProjectionGrid::new(&plane.window, 1);
    let over = (&plane.window, &plane.grid, &picture);
    let found = scattering::compare_chain(view, chain, over, BUDGET);
    let mut linear = found.slices.clone();
    if let Some(difference) = found.to_first_order {
        linear.half += &difference.slices.half;
    }
    [found.slices, linear]
}

/// Compares the photons of a plane with a modified chain, by the rule for first-order chains. The
/// slices are those of the modified chain, and `defect` is the part of its error that remains. All
/// else is as in the prediction `sound`, which needs a chain.
///
/// # Panics
/// Panics if the prediction has no chain.
pub(crate) fn judged_chain(
    (scene, measurement, plane): (&Scene, &Measurement, usize),
    sound: &Prediction,
    slices: Slices,
    defect: f64,
) -> FirstOrderReport {
    // The level of the test of the exact prediction, whose result is not used.
    const LEVEL: f64 = 0.01;
    let kept = sound.first_order.as_ref().expect("a chain");
    let tried = Prediction {
        first_order: Some(FirstOrder {
            slices,
            replicates: Vec::new(),
            chain: FirstOrderChain {
                defect,
                ..kept.chain.clone()
            },
        }),
        parameters: Vec::new(),
        ..sound.clone()
    };
    let compared = compared(scene, measurement, plane, &tried, LEVEL);
    compared.report.first_order.expect("a chain was given")
}
