//! The time that a prediction may take.

use etendue_scene::Scene;
use etendue_theory::RayBudget;

/// The largest accepted relative error of a prediction. This limit holds even if there are few
/// photons.
const MAX_ERROR: f64 = 1e-2;
/// The accepted relative error of a prediction, times √photons. The noise of the photons is about
/// 25/√photons.
const OF_NOISE: f64 = 12.0;
/// The number of rays of a prediction, as a share of the number of photons. This share is small
/// enough that the prediction takes less time than tracing the photons.
const SHARE: f64 = 0.25;
/// The largest number of rays for runs with few photons.
const FEWEST: f64 = 3e5;

/// The ray budget of a prediction. The prediction ends when its error is half of the
/// photons' noise. It also ends when it has taken about as long as the photons take. An error of
/// half the noise raises the smallest detectable change by 12 %. The lights of the scene share the
/// budget, and its planes share the time for closed forms.
pub(crate) fn budget(scene: &Scene) -> RayBudget {
    let photons = scene.run.photons as f64;
    let nodes = (SHARE * photons).max(FEWEST);
    let all = RayBudget::new(nodes, (OF_NOISE / photons.sqrt()).min(MAX_ERROR));
    let each = all.shared(1 + scene.other_lights.len());
    RayBudget {
        steps: each.steps / scene.planes.len() as f64,
        ..each
    }
}
