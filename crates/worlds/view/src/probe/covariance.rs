//! Measures covariances of the spectra along the ray of a pixel. Covariance tracing also propagates
//! the covariance at the first surface to the camera.

use super::scene::{BATCHES, FREQUENCIES, ProbeRequest, budget, seed_at};
use etendue_paths::{BackwardProbe, Probe};
use etendue_pipeline::covariance::{check_memory, fitting_options};
use etendue_pipeline::{Reporter, Work};
use etendue_predict::AXES;
use etendue_spectrum::field::{FieldCovariance, MatrixEstimate, measure_field};
use etendue_store::Failure;
use etendue_theory::covariance::{SpectralCovariance, window};
use etendue_theory::geometry::AffineMap;
use serde_json::{Value, json as tree_of};

/// The number of frequencies on either side of zero over which covariances are computed. It is half
/// of the number at the plane, because the noise of a second moment grows with the fourth power of
/// the band. Half of the band contains the spectra of the windows.
const BAND: usize = FREQUENCIES / 2;

/// The covariance of the spectrum of a plane.
#[derive(Clone, Debug)]
pub(super) struct FoundCovariance {
    /// The largest frequency of the covariance along each axis.
    band: [f64; 4],
    pub(super) measured: Option<MatrixEstimate>,
    growth: Option<[f64; 4]>,
    /// At the camera, the covariance by covariance tracing from the light that leaves the first
    /// surface; `None` at all other planes.
    pub(super) propagated: Option<MatrixEstimate>,
}

impl FoundCovariance {
    fn new(found: &FieldCovariance) -> Self {
        Self {
            band: found.band,
            measured: found.estimate(),
            growth: found.growth(),
            propagated: None,
        }
    }

    pub(super) fn tree(&self) -> Value {
        let of = |estimate: &Option<MatrixEstimate>| {
            estimate.map(|of| tree_of!({ "value": of.value, "error": of.error }))
        };
        tree_of!({
            "axes": AXES,
            "band": self.band,
            "measured": of(&self.measured),
            "growth": self.growth,
            "propagated": of(&self.propagated),
        })
    }
}

/// Measures the covariances of all planes with backward rays. The first plane is at the camera,
/// and the second records light that leaves the first surface.
pub(super) fn measured(
    probe: &Probe<'_>,
    request: &ProbeRequest,
    reporter: &dyn Reporter,
) -> Result<Vec<FoundCovariance>, Failure> {
    let mut planes = probe.planes.clone();
    for plane in &mut planes {
        plane.grid.rho.half = BAND;
        plane.grid.nu.half = BAND;
    }
    check_memory(&planes)?;
    let mut all = Vec::new();
    let steps = reporter.begin(Work::Steps {
        verb: "transforming",
        total: planes.len(),
        things: "planes",
    });
    steps.advance(0);
    for (index, plane) in planes.iter().enumerate() {
        let probe = probe.at_plane(index);
        let budget = budget(request.rays, seed_at(request.seed, index));
        let source = BackwardProbe::new(&probe, budget);
        let options = fitting_options(plane);
        let rays = budget.each * u64::from(BATCHES);
        let photons = if options.keep { rays } else { 2 * rays };
        let bar = reporter.begin(Work::Photons(photons));
        let field = measure_field(&source, 0, plane, 0..BATCHES, &options, &|done| {
            bar.advance(done);
        });
        drop(bar);
        all.extend(field.map_err(Failure::cannot_run)?.covariance);
        steps.advance(1);
    }
    drop(steps);
    let mut found: Vec<FoundCovariance> = all.iter().map(FoundCovariance::new).collect();
    if let (Some(camera), Some(leaving)) = (found.first_mut(), all.get(1)) {
        camera.propagated = propagated(probe, leaving);
    }
    Ok(found)
}

/// Propagates the covariance of light from the first surface to the camera. Subtracts the
/// covariance due to the window at the surface, applies the travel, and adds the covariance due to
/// the window at the camera.
fn propagated(probe: &Probe<'_>, leaving: &FieldCovariance) -> Option<MatrixEstimate> {
    let [camera, surface] = [0, 1].map(|i: usize| window(&probe.planes[i].window));
    let less = surface.map(|row| row.map(|entry| -entry));
    let travel = AffineMap::travel(probe.stops[0].distance);
    leaving.estimate_of(|measured| {
        let light = SpectralCovariance::of(measured).multiplied(&less);
        light.mapped(&travel)?.multiplied(&camera).matrix()
    })
}
