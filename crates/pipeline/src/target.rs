//! Photons until there is little enough noise, and how long less noise would take.

use crate::measure::measured;
use crate::reporter::Reporter;
use crate::table::{grouped, percent};
use etendue_compare::PlaneReport;
use etendue_field::tidy;
use etendue_scene::Scene;
use etendue_spectrum::{Measurement, estimate};
use etendue_store::Failure;
use etendue_store::Method;
use indicatif::HumanDuration;
use std::time::{Duration, Instant};

/// Photons of the first stage.
const FIRST_PHOTONS: u64 = 1 << 20;
/// The most photons of a stage, unless a user says so.
const MAX_PHOTONS: u64 = 1 << 40;
/// How many times as many photons the root of their number may ask for, that nets may do without.
const MAX_FACTOR: f64 = 8.0;

/// Measures all batches of a scene with 2ᵐ photons: the first of these numbers, from 2²⁰ on, with
/// which noise is at most a share `target` of the spectrum at each plane. The scene is given that
/// number. The last stage has `most` photons, a power of two or not.
///
/// A stage begins anew, so that its result is that of a run with as many photons. Which stages there
/// may be is fixed beforehand, and noise alone says which one is the last, so that p is as it would
/// be.
///
/// # Errors
/// When no photon comes to any plane, or more photons would be needed than `most`.
pub fn reached(
    scene: &mut Scene,
    method: Method,
    (target, most): (f64, Option<u64>),
    reporter: &dyn Reporter,
) -> Result<Measurement, Failure> {
    let most = most.unwrap_or(MAX_PHOTONS);
    let mut photons = FIRST_PHOTONS.min(most);
    loop {
        let begun = Instant::now();
        scene.run.photons = photons;
        scene.file.run.photons = photons;
        let measurement = measured(scene, method, 0..scene.run.batches, reporter)?;
        let emitted = grouped(photons);
        let Some((plane, noise)) = noisiest(&measurement) else {
            let none = format!("--target-error: none of {emitted} photons came into a window");
            return Err(Failure::cannot_run(none));
        };
        if noise <= target {
            return Ok(measurement);
        }
        let noise_now = percent(Some(noise));
        let now = format!("noise is {noise_now} at {plane} with {emitted} photons");
        // Nets may need fewer than the root of their number says: the largest power below that.
        let needed = photons as f64 * (noise / target).powi(2);
        let mut next = photons.saturating_mul(2);
        while next < most && 2.0 * next as f64 <= needed {
            next = next.saturating_mul(2);
        }
        if photons == most || needed > MAX_FACTOR * most as f64 {
            return Err(Failure::cannot_run(format!(
                "--target-error {} %: {now}, and falls as the root of their number or faster: \
                 {needed:.1e} photons reach that; allowed: {}, more by --photons",
                tidy(100.0 * target),
                grouped(most)
            )));
        }
        let next = next.min(most);
        {
            let time = begun.elapsed().mul_f64(next as f64 / photons as f64);
            let next = grouped(next);
            let time = HumanDuration(time);
            reporter.note(&format!("{now}: {next} photons follow, about {time}"));
        }
        photons = next;
    }
}

/// What noise the run has, and what a hundred times its time would bring, in words; `None` where
/// there is no light.
pub fn outlook(planes: &[PlaneReport], seconds: f64) -> Option<String> {
    let noise = |plane: &PlaneReport| plane.noise_limit;
    let lit = planes
        .iter()
        .filter_map(|plane| Some((&plane.name, noise(plane)?)));
    let (plane, noise) = lit.max_by(|(_, a), (_, b)| a.total_cmp(b))?;
    let longer = HumanDuration(Duration::try_from_secs_f64(100.0 * seconds).ok()?);
    let [noise, less] = [noise, 0.1 * noise].map(|noise| percent(Some(noise)));
    Some(format!(
        "noise is {noise} at {plane}; 100 times the photons, about {longer}, bring it to {less} \
         or below"
    ))
}

/// The plane of lit ones with the most noise, and how much of its spectrum that is.
fn noisiest(measurement: &Measurement) -> Option<(&str, f64)> {
    let planes = measurement.planes().iter().enumerate();
    let lit = planes.filter_map(|(i, plane)| {
        let noise = estimate::noise(measurement, i).ok()??;
        Some((plane.name.as_str(), noise))
    });
    lit.max_by(|(_, a), (_, b)| a.total_cmp(b))
}
