//! How long a prediction may take.

use etendue_scene::Scene;
use etendue_theory::RayBudget;

/// The largest relative error of a prediction that is accepted, however few the photons.
const MAX_ERROR: f64 = 3e-3;
/// The error that is accepted, times √photons. The photons' own noise is about 25/√photons.
const OF_NOISE: f64 = 12.0;
/// Rays of a prediction, as a share of the photons, so that it takes less time than tracing them.
const SHARE: f64 = 0.25;
/// Fewest rays, for runs with few photons.
const FEWEST: f64 = 1.1e6;

/// A prediction ends when its error is half of the photons' noise, with which the smallest
/// detectable change is 12 % larger than with none, or when it has taken about as long as tracing
/// the photons.
pub(crate) fn budget(scene: &Scene) -> RayBudget {
    let photons = scene.run.photons as f64;
    RayBudget {
        nodes: (SHARE * photons).max(FEWEST),
        error: (OF_NOISE / photons.sqrt()).min(MAX_ERROR),
    }
}
