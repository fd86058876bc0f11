//! Slices predicted by theory, with or without a planted modification.

use etendue_field::{ProjectionGrid, SliceGrid, Slices, VirtualPlane, Window};
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
