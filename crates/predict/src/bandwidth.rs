//! Predicts how fast a glossy reflection changes with angle, by the paper's criteria and by rays.

use crate::applicability::Applicability;
use crate::budget::budget;
use etendue_compare::lobe_cutoff;
use etendue_field::{Orientation, ProjectionGrid, Reflectance, VirtualPlane};
use etendue_scene::Scene;
use etendue_spectrum::CrossPower;
use etendue_spectrum::bandwidth::Along;
use etendue_theory::shading::Criterion;
use etendue_theory::{Model, PathKind, path};

/// The criterion for a plane behind a surface with a BRDF, perpendicular to the ray that
/// leaves this surface. Returns `None` for any other plane. The share
/// [`BANDWIDTH_FRACTION`](etendue_spectrum::bandwidth::BANDWIDTH_FRACTION) of a lobe's energy lies below its cutoff.
///
/// The edge that limits the light is the edge of the last blockers. Without blockers, the edge of
/// the light itself limits the light. Distant light has no such edge.
#[must_use]
pub fn criterion(
    scene: &Scene,
    plane: &VirtualPlane,
    applicability: &Applicability,
) -> Option<Criterion> {
    let view = applicability.theory.path_of(PathKind::Scattered)?;
    let system = &view.system;
    if plane.orientation != Orientation::Orthogonal {
        return None;
    }
    let chain = path::chain(view)?;
    let surface = &chain.scatterers[0];
    let from_light = surface.frame.origin.z;
    let last = system.masks_before(from_light).next_back();
    let last = last.map(|mask| mask.distance);
    let edge = if system.light.is_distant() {
        last
    } else {
        Some(last.unwrap_or(0.0))
    };
    Some(Criterion {
        curvature: surface.curvature[0][0],
        incidence: surface.incidence,
        outgoing: surface.outgoing[0],
        distance: scene.path.along(plane),
        blocker_distance: edge.map(|distance| from_light - distance),
        lobe_cutoff: sharpest_cutoff(system.scatterer().1),
        environment_cutoff: f64::INFINITY,
    })
}

/// The largest cutoff of the lobes of a sum; 0 if all lobes are centred on the normal.
fn sharpest_cutoff(reflectance: &Reflectance) -> f64 {
    let lobes = reflectance.terms.iter().map(|term| term.brdf.lobe);
    lobes.filter_map(lobe_cutoff).fold(0.0, f64::max)
}

/// The bandwidth along ν that the exact prediction has at a plane with a [`criterion`]. The
/// bandwidth of photons is computed by the same estimator.
#[must_use]
pub fn exact_bandwidth(
    scene: &Scene,
    plane: &VirtualPlane,
    applicability: &Applicability,
) -> Option<f64> {
    let view = applicability.theory.path_of(PathKind::Scattered)?;
    let (window, grid) = (&plane.window, &plane.grid);
    let picture = ProjectionGrid::new(window, 1);
    let over = (window, grid, &picture);
    let exact = view.predict(&[], over, budget(scene));
    let power = CrossPower::of_replicates(&exact.replicates, 0..grid.azimuths).ok()?;
    Some(power.bandwidth(Along::Nu)?.value.value)
}
