//! Checks that the photons and rays of a failed plane are enough for its verdict.

use crate::case::MeasuredScene;
use crate::method::source;
use etendue_compare::{Class, MIN_PHOTONS_PER_BATCH, PlaneComparison, Verdict};
use etendue_field::Crossing;
use etendue_scene::Scene;
use etendue_store::{Failure, Method};
use rayon::prelude::*;

/// Makes a failed plane undecided if too few of the photons aimed at its window reach it.
///
/// The tracer aims an equal share of the photons at each window. Photons aimed at a window may
/// rarely reach it, for example behind a curved mirror. Then the measurement of this plane may
/// contain only photons that were aimed at other windows. The estimated error of such a measurement
/// is far too small.
pub(crate) fn leave_open(
    case: &MeasuredScene,
    planes: &mut [PlaneComparison],
) -> Result<(), Failure> {
    let count = case.scene.planes.len() as u64;
    if count < 2 {
        return Ok(());
    }
    for (plane, compared) in planes.iter_mut().enumerate() {
        let report = &mut compared.report;
        let by_photons = case.method == Method::Photons || report.class == Class::Reference;
        if report.exact_verdict() != Verdict::Fail || !by_photons {
            continue;
        }
        let photons = case.scene.run.photons / count;
        let reach = reached(case.scene.seen_at(&[plane]), Method::Photons, photons)?;
        if (reach as f64) < MIN_PHOTONS_PER_BATCH * f64::from(case.scene.run.batches) {
            let has_wrong_map = report.first_order.as_mut().is_some_and(|chain| {
                chain.exact = Verdict::Undecided;
                chain.verdict == Verdict::Fail
            });
            if !has_wrong_map {
                report.verdict = Verdict::Undecided;
            }
            report.undecided = Some(format!(
                "{reach} of {photons} photons that are aimed at this window reach it, and photons aimed at other windows may cover only a part of this window. Measure this plane alone, or use --method backward"
            ));
        }
    }
    Ok(())
}

/// Makes a failed comparison of photons with backward rays undecided if too few of either find one of
/// several lights. The light of the others would hide that this light is missing.
pub(crate) fn leave_hidden_lights_open(
    case: &MeasuredScene,
    planes: &mut [PlaneComparison],
) -> Result<(), Failure> {
    let lights = case.scene.lights().count() as u64;
    if lights < 2 {
        return Ok(());
    }
    let rays = case.scene.run.photons / lights;
    let least = MIN_PHOTONS_PER_BATCH * f64::from(case.scene.run.batches);
    for PlaneComparison { report, .. } in planes {
        if report.class != Class::Reference || report.exact_verdict() != Verdict::Fail {
            continue;
        }
        for (number, light) in (1..).zip(case.scene.lights()) {
            let Some(own) = light.plane_named(&report.name) else {
                continue;
            };
            let alone = Scene {
                other_lights: Vec::new(),
                ..light.seen_at(&[own])
            };
            let photons = reached(alone.clone(), Method::Photons, rays)?;
            let back = reached(alone, Method::Backward, rays)?;
            if photons.max(back) > 0 && (photons.min(back) as f64) < least {
                report.verdict = Verdict::Undecided;
                report.undecided = Some(format!(
                    "{photons} photons and {back} backward rays find light {number}, which are too few to compare them. Use more photons"
                ));
            }
        }
    }
    Ok(())
}

/// Returns how many of `photons` photons or rays of a scene with one plane reach the window of this
/// plane.
fn reached(mut alone: Scene, method: Method, photons: u64) -> Result<u64, Failure> {
    alone.run.photons = photons;
    let source = source(&alone, method)?;
    let window = &alone.planes[0].window;
    let of_batch = |batch: u32| {
        let mut inside = 0;
        let mut count = |_: usize, crossings: &[Crossing]| {
            let seen = crossings.iter().filter(|c| window.value(&c.ray) > 0.0);
            inside += seen.count() as u64;
        };
        source.emit(batch, &mut count, &|_| ());
        inside
    };
    Ok((0..alone.run.batches).into_par_iter().map(of_batch).sum())
}
