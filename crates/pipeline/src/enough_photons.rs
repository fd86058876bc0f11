//! Checks that the photons and rays of a failed plane are enough for its verdict.

use crate::measure::MeasuredScene;
use crate::method::{judge_of, source};
use etendue_compare::{Class, MIN_PHOTONS_PER_BATCH, PlaneComparison, Verdict};
use etendue_field::{Crossing, PhotonSource, Window, percent};
use etendue_predict::predict_lights;
use etendue_scene::Scene;
use etendue_store::{Failure, Method};
use etendue_trace::AllLights;
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
    // All photons are aimed at the only window.
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
        if (reach as f64) < least(case) {
            let has_wrong_map = report.first_order.as_mut().is_some_and(|chain| {
                chain.exact = Verdict::Undecided;
                chain.verdict == Verdict::Fail
            });
            // A chain that fails beside exact theory is wrong for any number of photons.
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

/// Makes a failed plane undecided if too few photons or rays of one of several lights reach its
/// window. The light of the others would hide that this light is missing.
pub(crate) fn leave_hidden_lights_open(
    case: &MeasuredScene,
    planes: &mut [PlaneComparison],
) -> Result<(), Failure> {
    if case.scene.other_lights.is_empty() {
        return Ok(());
    }
    for (plane, compared) in planes.iter_mut().enumerate() {
        if compared.report.exact_verdict() != Verdict::Fail {
            continue;
        }
        let hidden = if compared.report.class == Class::Reference {
            hidden_from_tracers(case, plane)?
        } else {
            hidden_from_photons(case, plane, compared)?
        };
        if let Some(hidden) = hidden {
            compared.report.verdict = Verdict::Undecided;
            compared.report.undecided = Some(hidden);
        }
    }
    Ok(())
}

/// The number of photons or rays that show how often another method reaches a window.
const TRIED: u64 = 1 << 14;
/// Another method is named if it reaches the window this many times as often.
const MORE_OFTEN: f64 = 10.0;

/// Names the other method at planes that more photons would decide, if it reaches the window much
/// more often.
pub(crate) fn name_other_method(case: &MeasuredScene, planes: &mut [PlaneComparison]) {
    for (plane, compared) in planes.iter_mut().enumerate() {
        let report = &mut compared.report;
        let is_rare = report.in_window == 0 || report.photons_needed.is_some();
        let Some(why) = report.undecided.as_mut().filter(|_| is_rare) else {
            continue;
        };
        let other = judge_of(case.method, &case.scene, &case.scene.planes[plane]);
        if report.class == Class::Reference || matches!(other, Method::Even | Method::Given) {
            continue;
        }
        // A scene that the other method cannot measure is no reason to fail.
        let Ok(tried) = reached(case.scene.seen_at(&[plane]), other, TRIED) else {
            continue;
        };
        let tried = tried as f64 / TRIED as f64;
        // A part of the photons is aimed at each window.
        let aimed = case.scene.run.photons as f64 / case.scene.planes.len() as f64;
        let often = tried * aimed / (report.in_window as f64).max(1.0);
        if often > MORE_OFTEN {
            let name = other.name();
            *why += &format!(
                "; --method {name} has {often:.0} times as many rays in this window, so use it"
            );
        }
    }
}

/// The number of photons or rays that a verdict needs in a window.
fn least(case: &MeasuredScene) -> f64 {
    MIN_PHOTONS_PER_BATCH * f64::from(case.scene.run.batches)
}

/// A light that one of two tracers finds too rarely, in words.
fn hidden_from_tracers(case: &MeasuredScene, plane: usize) -> Result<Option<String>, Failure> {
    let judge = judge_of(case.method, &case.scene, &case.scene.planes[plane]);
    let this = reached_by_light(case, plane, case.method)?;
    let other = reached_by_light(case, plane, judge)?;
    let lights = (1..).zip(this.into_iter().zip(other));
    let mut hidden = lights.filter(|(_, (this, other))| {
        (*this).max(*other) > 0 && ((*this).min(*other) as f64) < least(case)
    });
    let [method, judge] = [case.method, judge].map(Method::words);
    Ok(hidden.next().map(|(number, (this, other))| {
        format!(
            "{this} {method} and {other} {judge} find light {number}, which are too few to compare them. Use more photons"
        )
    }))
}

/// A light, in words, of which theory predicts more light than the noise, but which the
/// photons find too rarely.
fn hidden_from_photons(
    case: &MeasuredScene,
    plane: usize,
    compared: &PlaneComparison,
) -> Result<Option<String>, Failure> {
    let Some(noise) = compared.report.noise_limit else {
        return Ok(None);
    };
    let found = reached_by_light(case, plane, case.method)?;
    let is_rare = |count: &u64| (*count as f64) < least(case);
    if !found.iter().any(is_rare) {
        return Ok(None);
    }
    let all = compared.predicted.norm();
    let at = &case.scene.planes[plane];
    let mut lights = predict_lights(&case.scene, at, &case.theories[plane]);
    Ok(lights.find_map(|(number, light)| {
        let count = found.get(number - 1).filter(|count| is_rare(count))?;
        let share = light.slices.norm() / all;
        (share > noise).then(|| {
            format!(
                "{} of the predicted spectrum comes from light {number}, but {count} {} in the window are from this light, which are too few to compare. Use more photons",
                percent(share, 3),
                case.method.words()
            )
        })
    }))
}

/// How many of `photons` photons or rays of a scene with one plane reach the window of this
/// plane.
fn reached(mut alone: Scene, method: Method, photons: u64) -> Result<u64, Failure> {
    alone.run.photons = photons;
    let source = source(&alone, method)?;
    Ok(inside(
        &*source,
        0,
        &alone.planes[0].window,
        alone.run.batches,
    ))
}

/// How many photons or rays of each light reach the window of a plane.
fn reached_by_light(
    case: &MeasuredScene,
    plane: usize,
    method: Method,
) -> Result<Vec<u64>, Failure> {
    let scene = &case.scene;
    Ok(match method {
        Method::Photons | Method::Difference => of_each(&AllLights::photons(scene), scene, plane),
        Method::Even => of_each(&AllLights::with_uniform_emission(scene), scene, plane),
        Method::Given => Vec::new(),
        Method::Backward => {
            let lights = AllLights::backward(scene).map_err(Failure::bad_input)?;
            of_each(&lights, scene, plane)
        }
    })
}

fn of_each<S: PhotonSource>(lights: &AllLights<S>, scene: &Scene, plane: usize) -> Vec<u64> {
    let window = &scene.planes[plane].window;
    let reached = |(source, planes): (&S, &[usize])| {
        let own = planes.iter().position(|whole| *whole == plane);
        own.map_or(0, |own| inside(source, own, window, scene.run.batches))
    };
    lights.each().map(reached).collect()
}

/// How many of the photons of a source are inside the window of its plane `plane`.
fn inside(source: &dyn PhotonSource, plane: usize, window: &Window, batches: u32) -> u64 {
    let of_batch = |batch: u32| {
        let mut inside = 0;
        let mut count = |at: usize, crossings: &[Crossing]| {
            let seen = crossings.iter().filter(|c| window.value(&c.ray) > 0.0);
            inside += if at == plane { seen.count() as u64 } else { 0 };
        };
        source.emit(batch, &mut count, &|_| ());
        inside
    };
    (0..batches).into_par_iter().map(of_batch).sum()
}
