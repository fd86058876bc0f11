//! Predicts the Monte Carlo errors of samplers at the planes of a probe, and finds these errors.

use super::scene::{BATCHES, ProbeRequest, budget, seed_at};
use etendue_field::{TwoPlane, VirtualPlane};
use etendue_paths::{BackwardProbe, Probe};
use etendue_pipeline::Reporter;
use etendue_store::Failure;
use etendue_studies::variance::{
    PlaneVariance, RayRadiance, VarianceOptions, VarianceStudy, WindowLight, WindowRadiance,
    box_window,
};

/// The differences between the seed of the backward rays and the seeds of the rays for the spectrum
/// and for single radiances.
const SPECTRUM_SEED: u64 = 1 << 62;
const RADIANCE_SEED: u64 = 3 << 62;

/// The radiance along rays through the only plane of a probe.
#[derive(Debug)]
struct ProbeRadiance<'a> {
    probe: &'a Probe<'a>,
    seed: u64,
}

impl RayRadiance for ProbeRadiance<'_> {
    fn along(&self, ray: &TwoPlane, index: u64) -> f64 {
        self.probe
            .radiance(&self.probe.planes[0], ray, self.seed, index)
    }
}

/// The variances at each plane. A plane is left out if it is dark, or if the radiance is the
/// same over its whole window.
pub(super) fn studied(
    request: &ProbeRequest,
    options: &VarianceOptions,
    (probe, are_dark): (&Probe<'_>, &[bool]),
    reporter: &dyn Reporter,
) -> Result<Vec<Option<PlaneVariance>>, Failure> {
    let of_plane = |(number, (plane, is_dark)): (usize, (&VirtualPlane, &bool))| {
        if *is_dark {
            return Ok(None);
        }
        let plane = box_window(plane, options.frequencies);
        let window = plane.window;
        let probe = probe.seen_at(plane.clone());
        let seed = seed_at(request.seed, number);
        let budget = budget(request.rays, seed ^ SPECTRUM_SEED);
        let radiance = ProbeRadiance {
            probe: &probe,
            seed: seed ^ RADIANCE_SEED,
        };
        let light = WindowLight {
            source: Box::new(BackwardProbe::new(&probe, budget)),
            radiance: WindowRadiance::of(window, Box::new(radiance)),
            plane,
            batches: BATCHES,
            photons: request.rays,
            seed,
        };
        let study = VarianceStudy::of_light(light, options.clone())?;
        study.check_memory()?;
        study.run(reporter)
    };
    let planes = probe.planes.iter().zip(are_dark).enumerate();
    planes.map(of_plane).collect()
}
