//! Tests scenes for which theory once was wrong, stated too small an error, or gave no prediction
//! (results/wild.md).

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test that cannot go on should stop; what it prints is the table of results/wild.md"
)]

mod classes;
mod light;
mod obstacles;
mod surfaces;

use crate::common::{self, photons};
use crate::scenes::{referred, traced_backwards};
use etendue_compare::{Class, PlaneReport, Prediction, Test, Verdict, compare};
use etendue_field::{ProjectionGrid, Slices, VirtualPlane};
use etendue_predict::{Applicability, path, predict, test_of};
use etendue_scene::Scene;
use etendue_spectrum::Measurement;
use etendue_theory::path::PathSystem;
use etendue_theory::{Model, Observed, RayBudget};
use std::time::Instant;

/// A scene of `scenes/wild`, with parts of its text replaced.
fn edited(name: &str, edits: &[(&str, &str)]) -> Scene {
    common::edited(&format!("wild/{name}"), edits)
}

/// A scene of `scenes/wild`.
fn scene(name: &str) -> Scene {
    edited(name, &[])
}

/// The number of photons in a scene file, and a larger number that replaces it. With the larger
/// number, many rays of each batch hit a bright pixel through the lobe.
const MORE: (&str, &str) = ("photons: 200_000", "photons: 2_000_000");

fn backward(scene: &Scene) -> Measurement {
    traced_backwards(scene).unwrap()
}

fn report(
    scene: &Scene,
    measurement: &Measurement,
    plane: usize,
    prediction: &Prediction,
) -> PlaneReport {
    // Noise of 50 % is low enough to detect predictions with an error of 50 %.
    let test = Test {
        resolution: 0.5,
        ..test_of(scene)
    };
    let compared = compare(measurement, plane, prediction, &test);
    compared.unwrap().report
}

fn verdict(scene: &Scene, measurement: &Measurement, prediction: &Prediction) -> Verdict {
    report(scene, measurement, 0, prediction).verdict
}

fn by_theory(scene: &Scene, plane: &VirtualPlane) -> Prediction {
    predict(scene, plane, &Applicability::new(scene, plane))
}

/// The prediction by exact rays, without the affine chain, whose verdict is separate.
fn by_exact_rays(scene: &Scene, plane: usize) -> Prediction {
    Prediction {
        first_order: None,
        ..by_theory(scene, &scene.planes[plane])
    }
}

/// The row of results/wild.md that describes a plane.
fn row(scene: &Scene, class: Class, by: &str, seconds: f64, report: &PlaneReport) {
    let percent = |x: Option<f64>| x.map_or("–".to_owned(), |x| format!("{:.2} %", 100.0 * x));
    println!(
        "| {} | {} | {class} | {seconds:.1} | {} | {by} | {} / {} | {:?} | {} |",
        scene.name,
        report.name,
        percent(report.quadrature_error),
        percent(report.relative_error),
        percent(report.noise_limit),
        report.verdict,
        report.p_value.map_or("–".to_owned(), |p| format!("{p:.4}")),
    );
}

/// Checks that the planes of a scene have the given names, separated by blanks, and the expected
/// class of theory, and that no verdict is a failure. Photons decide the verdict on each plane; if
/// they are undecided and a backward tracer exists, backward rays decide.
fn does_not_fail(name: &str, class: Class, planes: &str) {
    scene_does_not_fail(&scene(name), class, planes);
}

fn scene_does_not_fail(scene: &Scene, class: Class, planes: &str) {
    let name = &scene.name;
    let by_photons = photons(scene);
    let by_rays = traced_backwards(scene);
    let names: Vec<&str> = scene
        .planes
        .iter()
        .map(|plane| plane.name.as_str())
        .collect();
    assert_eq!(names.join(" "), planes, "{name}");
    for (i, plane) in scene.planes.iter().enumerate() {
        let called = &plane.name;
        let found = Applicability::new(scene, plane).class();
        assert_eq!(found, class, "{name}: {called}");
        let begun = Instant::now();
        let prediction = match class {
            Class::Reference => referred(scene, i, by_rays.as_ref().unwrap()),
            _ => by_theory(scene, plane),
        };
        let seconds = begun.elapsed().as_secs_f64();
        let judged = report(scene, &by_photons, i, &prediction);
        row(scene, found, "photons", seconds, &judged);
        assert_ne!(judged.verdict, Verdict::Fail, "{name}: {called}, photons");
        let undecided = judged.verdict == Verdict::Undecided;
        if let Some(by_rays) = by_rays.as_ref().filter(|_| undecided) {
            let judged = report(scene, by_rays, i, &prediction);
            row(scene, found, "rays", seconds, &judged);
            assert_ne!(judged.verdict, Verdict::Fail, "{name}: {called}, rays");
        }
    }
}

/// Checks that photons and backward rays agree with theory at the first plane.
fn both_tracers_agree_with_theory(scene: &Scene) {
    let prediction = by_theory(scene, &scene.planes[0]);
    for measured in [photons(scene), backward(scene)] {
        let judged = verdict(scene, &measured, &prediction);
        assert_eq!(judged, Verdict::Pass, "{}", scene.name);
    }
}

/// Checks that photons agree with backward rays at the first plane.
fn the_tracers_agree(scene: &Scene) {
    let reference = referred(scene, 0, &backward(scene));
    let judged = verdict(scene, &photons(scene), &reference);
    assert_eq!(judged, Verdict::Pass, "{}", scene.name);
}

/// Checks that theory agrees with both tracers on light that some surface of the path stops, and
/// that photons disagree with a prediction that is blind to this surface.
fn only_the_blind_are_wrong(scene: &Scene, plane: usize, blind: fn(&mut PathSystem)) {
    let right = by_exact_rays(scene, plane);
    let photons = photons(scene);
    for measured in [&photons, &backward(scene)] {
        let judged = report(scene, measured, plane, &right);
        assert_eq!(judged.verdict, Verdict::Pass);
    }
    let mut view = path(scene, &scene.planes[plane]).unwrap();
    blind(&mut view.system);
    let wrong = by_path(scene, plane, &view, right);
    let judged = report(scene, &photons, plane, &wrong);
    assert_eq!(judged.verdict, Verdict::Fail);
}

/// Makes a prediction blind to surfaces that light visits later.
fn forgets_later_surfaces(system: &mut PathSystem) {
    system.surfaces.truncate(system.visited);
    system.obstacles.clear();
}

/// Makes a prediction blind to the shadow of a surface on itself.
fn forgets_own_shadows(system: &mut PathSystem) {
    for surface in &mut system.surfaces {
        surface.occludes = false;
    }
}

/// Budget with which a prediction has an error of half a per cent in each of these scenes.
const BUDGET: RayBudget = RayBudget::new(1e6, 5e-3);

fn by_path(scene: &Scene, plane: usize, view: &Observed, like: Prediction) -> Prediction {
    let (window, grid) = (&scene.planes[plane].window, like.slices.grid);
    let picture = ProjectionGrid::new(window, 1);
    let found = view.predict(&[], (window, &grid, &picture), BUDGET);
    replaced(like, found.slices, found.replicates)
}

/// A prediction with its slices replaced by others.
fn replaced(like: Prediction, slices: Slices, replicates: Vec<Slices>) -> Prediction {
    Prediction {
        quadrature_error: None,
        mesh_error: None,
        rule_error: None,
        slices,
        replicates,
        ..like
    }
}
