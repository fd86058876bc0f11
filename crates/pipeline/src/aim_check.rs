//! Checks that photons aimed at the window of a plane reach it.

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
        let reach = reached(&case.scene, plane, photons)?;
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

/// Returns how many of `photons` photons reach the window of a plane if all of them are aimed at
/// this window.
fn reached(scene: &Scene, plane: usize, photons: u64) -> Result<u64, Failure> {
    let mut alone = scene.seen_at(&[plane]);
    alone.run.photons = photons;
    let source = source(&alone, Method::Photons)?;
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
