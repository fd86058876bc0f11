//! How long a prediction by nets of rays goes on.

use etendue_scene::Scene;
use etendue_theory::Budget;

/// The largest relative error of a prediction that is accepted, however few the photons.
const LARGEST: f64 = 2e-3;
/// The error that is accepted, times √photons. The photons' own noise is about 25/√photons.
const OF_NOISE: f64 = 8.0;
/// Rays of a prediction, as a share of the photons, so that it takes less time than tracing them.
const SHARE: f64 = 0.25;
/// Fewest rays, for runs with few photons.
const FEWEST: f64 = 5e5;

/// A prediction ends when its error is a third of the photons' noise, which takes a twentieth off the
/// power of the test, or when it has taken about as long as tracing the photons.
pub(crate) fn budget(scene: &Scene) -> Budget {
    let photons = scene.run.photons as f64;
    Budget {
        nodes: (SHARE * photons).max(FEWEST),
        error: (OF_NOISE / photons.sqrt()).min(LARGEST),
    }
}
