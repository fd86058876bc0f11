//! Slices that theory predicts for a system, tampered with or not.

use etendue_field::{ProjectionGrid, SliceGrid, Slices, VirtualPlane, Window};
use etendue_theory::Budget;
use etendue_theory::geometry::SpectrumMap;
use etendue_theory::rays::{self, Plane};
use etendue_theory::scattering::{self, Chain};

/// Rays of a prediction: errors of a fifth of the photons' noise.
const BUDGET: Budget = Budget {
    nodes: 5e6,
    error: 5e-4,
};

/// Behind specular surfaces.
pub(crate) fn traced(
    system: &rays::System,
    at: &Plane,
    window: &Window,
    grid: &SliceGrid,
) -> rays::RaySlices {
    let picture = ProjectionGrid::new(window, 1);
    rays::exact(system, at, (window, grid, &picture), BUDGET)
}

/// Behind specular surfaces, by a chain.
pub(crate) fn linear(
    system: &rays::System,
    at: &Plane,
    window: &Window,
    grid: &SliceGrid,
    map: &SpectrumMap<4>,
) -> Slices {
    let picture = ProjectionGrid::new(window, 1);
    rays::linear(system, at, (window, grid, &picture), map, BUDGET).slices
}

/// Behind a surface with a BRDF: as it is, and by a chain.
pub(crate) fn scattered(
    system: &scattering::System,
    at: &Plane,
    plane: &VirtualPlane,
    chain: &Chain,
) -> [Slices; 2] {
    let (window, grid) = (&plane.window, &plane.grid);
    let picture = ProjectionGrid::new(window, 1);
    let over = (window, grid, &picture);
    let exact = scattering::predict(system, at, Some(chain), over, BUDGET);
    let around = scattering::differences(system, at, Some(chain), &[], (window, grid), &exact);
    let mut linear = exact.slices.clone();
    if let Some(difference) = around.linear {
        linear.half += &difference.half;
    }
    [exact.slices, linear]
}
