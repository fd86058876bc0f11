//! Adds photons until noise is low enough.

use crate::measure::measured;
use crate::reporter::Reporter;
use etendue_field::{grouped, percent, tidy};
use etendue_scene::Scene;
use etendue_spectrum::{Measurement, estimate};
use etendue_store::{Failure, Method};
use std::time::Instant;

/// Number of photons of the first measurement.
const FIRST_PHOTONS: u64 = 1 << 20;
/// The maximum number of photons of a measurement, unless the user sets another maximum.
const MAX_PHOTONS: u64 = 1 << 40;
/// The largest allowed ratio of two numbers of photons: the number that the square-root law
/// predicts, and the maximum number. With nets, fewer photons may suffice.
const MAX_FACTOR: f64 = 8.0;

/// Measures all batches of a scene, with so many photons that the noise at each plane is at most
/// the share `target` of the spectrum. The number of photons is the smallest sufficient power of
/// two that is at least 2²⁰. The function sets the number of photons in the scene to this power
/// of two. The last possible measurement has `most` photons, which need not be a power of two.
///
/// Each measurement starts again from the first photon, so its result equals the result of a run
/// with the same number of photons. The possible numbers of photons are fixed beforehand, and only
/// noise decides which number is the last, so p-values are not biased.
///
/// # Errors
/// When no photon reaches any plane, or when more than `most` photons would be needed.
pub(crate) fn reached(
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
            let none = format!("--target-error: none of {emitted} photons reached a window");
            return Err(Failure::cannot_run(none));
        };
        if noise <= target {
            return Ok(measurement);
        }
        let noise_now = percent(noise, 3);
        let now = format!("noise is {noise_now} at {plane} with {emitted} photons");
        // With nets, fewer photons than the square-root law predicts may suffice, so the next
        // measurement has the largest power of two below the predicted number.
        let needed = photons as f64 * (noise / target).powi(2);
        let mut next = photons.saturating_mul(2);
        while next < most && 2.0 * next as f64 <= needed {
            next = next.saturating_mul(2);
        }
        if photons == most || needed > MAX_FACTOR * most as f64 {
            return Err(Failure::cannot_run(format!(
                "--target-error {} %: {now}. With four times as many photons, noise falls to a half or less, so {needed:.1e} photons suffice; allowed: {}, or more with --photons",
                tidy(100.0 * target),
                grouped(most)
            )));
        }
        let next = next.min(most);
        reporter.note_step(
            &format!("{now}: the next step traces {} photons", grouped(next)),
            begun.elapsed().mul_f64(next as f64 / photons as f64),
        );
        photons = next;
    }
}

/// The name of the plane with the most noise among planes with light, and its noise as a
/// share of the spectrum.
fn noisiest(measurement: &Measurement) -> Option<(&str, f64)> {
    let planes = measurement.planes().iter().enumerate();
    let lit = planes.filter_map(|(i, plane)| {
        let noise = estimate::noise(measurement, i).ok()??;
        Some((plane.name.as_str(), noise))
    });
    lit.max_by(|(_, a), (_, b)| a.total_cmp(b))
}
