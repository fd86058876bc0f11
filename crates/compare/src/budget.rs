//! How long a prediction may take.

use etendue_field::{ProjectionGrid, VirtualPlane};
use etendue_scene::Scene;
use etendue_spectrum::PROJECTION_BINS;
use etendue_theory::{Budget, Chain};

/// The largest relative error of a prediction that is accepted, however few the photons.
const LARGEST: f64 = 3e-3;
/// The error that is accepted, times √photons. The photons' own noise is about 25/√photons.
const OF_NOISE: f64 = 12.0;
/// Rays of a prediction, as a share of the photons, so that it takes less time than tracing them.
const SHARE: f64 = 0.25;
/// Fewest rays, for runs with few photons.
const FEWEST: f64 = 1.1e6;

/// A prediction ends when its error is half of the photons' noise, with which the smallest detectable
/// change is 12 % larger than with none, or when it has taken about as long as tracing the photons.
pub(crate) fn budget(scene: &Scene) -> Budget {
    let photons = scene.run.photons as f64;
    Budget {
        nodes: (SHARE * photons).max(FEWEST),
        error: (OF_NOISE / photons.sqrt()).min(LARGEST),
    }
}

/// Steps of a quadrature over a receiver that are accepted, some five seconds of two cores.
const OF_QUADRATURES: f64 = 1e10;
/// Steps of a closed form that are accepted: nets need as many rays as photons to come near it.
const OF_CLOSED_FORMS: f64 = 1e11;
/// Bytes of a closed form on one core that are accepted.
const BYTES: f64 = 1e9;

/// Whether nets of rays take the place of a chain's closed form or quadrature: where that takes
/// very long, or does not resolve a pattern.
pub(crate) fn is_sampled(plane: &VirtualPlane, chain: &Chain) -> bool {
    let (window, grid) = (&plane.window, &plane.grid);
    let picture = ProjectionGrid::new(window, PROJECTION_BINS);
    let work = etendue_theory::work(chain, window, grid, &picture);
    let accepted = if chain.is_reflected() {
        OF_QUADRATURES
    } else {
        OF_CLOSED_FORMS
    };
    !chain.is_resolved(window) || work.steps > accepted || work.bytes + work.bytes_each > BYTES
}
