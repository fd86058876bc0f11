//! Tests of environment light on a leg and on surfaces: photons must agree with correct
//! predictions, and disagree with predictions that have a fault.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::{edited, photons};
use etendue_compare::Residuals;
use etendue_field::{Light, Orientation, ProjectionGrid, Quantity, VirtualPlane};
use etendue_predict::{Applicability, path};
use etendue_scene::Scene;
use etendue_spectrum::Measurement;
use etendue_theory::{Model, Observed, Predicted, RayBudget};
use glam::{DQuat, DVec3};

/// The budget of a prediction. With this budget, the error of a prediction in these tests is a few
/// times the error of the photons.
const BUDGET: RayBudget = RayBudget::new(2e6, 1e-3);
/// Photons per scene.
const PHOTONS: u64 = 1 << 22;
/// False rejection rate over all planes.
const ALPHA: f64 = 0.01;

/// A fault planted in a system.
type Fault = (&'static str, fn(&mut Observed));

/// A scene of the repository, with fewer photons than its file states.
fn scene(name: &str) -> Scene {
    let mut scene = edited(name, &[]);
    scene.run.photons = PHOTONS;
    scene
}

fn predicted(view: &Observed, plane: &VirtualPlane) -> Predicted {
    let picture = ProjectionGrid::new(&plane.window, 1);
    view.predict(&[], (&plane.window, &plane.grid, &picture), BUDGET)
}

/// Checks that photons agree with the prediction of a plane, and disagree with the prediction with
/// each fault.
fn tells(scene: &Scene, photons: &Measurement, name: &str, faults: &[Fault]) {
    let plane = scene.planes.iter().find(|plane| plane.name == name);
    let view = path(scene, plane.unwrap()).unwrap();
    tells_in(&view, scene, photons, name, faults);
}

fn tells_in(view: &Observed, scene: &Scene, photons: &Measurement, name: &str, faults: &[Fault]) {
    let plane = scene.planes.iter().position(|p| p.name == name).unwrap();
    let p = |fault: fn(&mut Observed)| {
        let mut view = view.clone();
        fault(&mut view);
        let found = predicted(&view, &scene.planes[plane]);
        let residuals = Residuals::between(photons, plane, &found.slices, &found.replicates);
        residuals.p_value(scene.run.seed).unwrap()
    };
    let sound = p(|_| ());
    assert!(sound > ALPHA / 6.0, "{name}: {sound}");
    for (words, fault) in faults {
        let planted = p(*fault);
        assert!(planted < 1e-3, "{name}, {words}: {planted}");
    }
}

/// Rotates the axes of a surface by half a turn about the normal of this surface.
fn turned_round(view: &mut Observed) {
    let frame = &mut view.plane.frame;
    (frame.x, frame.y) = (-frame.x, -frame.y);
}

/// Replaces a convex sphere by a hollow one.
fn hollow(view: &mut Observed) {
    let patch = view.plane.patch.as_mut().unwrap();
    patch.curvature = patch.curvature.map(|k| -k);
}

/// Increases the curvature of a sphere by one per cent.
fn more_curved(view: &mut Observed) {
    let patch = view.plane.patch.as_mut().unwrap();
    patch.curvature = patch.curvature.map(|k| 1.01 * k);
}

fn without_cosine(view: &mut Observed) {
    view.plane.quantity = Quantity::Radiance;
}

fn mirrored(view: &mut Observed) {
    view.plane.orientation = Orientation::Mirrored;
}

/// Rotates the environment by one degree.
fn turned_light(view: &mut Observed) {
    turn(&mut view.system.light, 1.0);
}

fn turn(light: &mut Light, degrees: f64) {
    let Light::Environment { environment } = light else {
        panic!("an environment");
    };
    let turn = DQuat::from_axis_angle(DVec3::Y, degrees.to_radians());
    let frame = &mut environment.frame;
    (frame.x, frame.y, frame.d) = (turn * frame.x, turn * frame.y, turn * frame.d);
}

fn without_masks(view: &mut Observed) {
    view.system.masks.clear();
}

/// Checks Fig. 3, five suns behind a grating, in slopes and in angles. The arrangement of the
/// five suns is symmetric under a rotation by half a turn.
#[test]
#[ignore = "long: half a minute; .ci/long runs it"]
fn two_parameterisations() {
    let scene = scene("fig3");
    let photons = photons(&scene);
    let faults: [Fault; 2] = [("no masks", without_masks), ("light turned", turned_light)];
    for plane in ["travel", "plane_sphere"] {
        tells(&scene, &photons, plane, &faults);
    }
}

/// Checks Fig. 14: the light on a sphere, before the sphere's lobes act on it.
#[test]
#[ignore = "long: half a minute; .ci/long runs it"]
fn the_steps_of_shading() {
    let scene = scene("fig14");
    let photons = photons(&scene);
    let faults: [Fault; 2] = [
        ("frame turned", turned_round),
        ("light turned", turned_light),
    ];
    tells(&scene, &photons, "environment", &faults);
    let faults: [Fault; 3] = [
        ("sign of curvature", hollow),
        ("curvature by 1 %", more_curved),
        ("turned about the normal", mirrored),
    ];
    tells(&scene, &photons, "curvature", &faults);
    let faults: [Fault; 2] = [("no cosine", without_cosine), ("sign of curvature", hollow)];
    tells(&scene, &photons, "cosine", &faults);
}

/// Checks a scene in which an environment lights a diffuse wall and then a glossy floor.
#[test]
#[ignore = "long: half a minute; .ci/long runs it"]
fn behind_several_surfaces() {
    let scene = scene("wild/sky_on_walls");
    let photons = photons(&scene);
    let faults: [Fault; 3] = [
        ("no card", |view| view.system.masks.clear()),
        ("light turned", |view| turn(&mut view.system.light, 3.0)),
        ("floor flat", |view| {
            view.system.surfaces[1].patch.curvature = [0.0; 3];
        }),
    ];
    for (plane, faults) in [("leaving_wall", &faults[..2]), ("beyond", &faults[..])] {
        let number = scene.planes.iter().position(|p| p.name == plane).unwrap();
        let found = Applicability::new(&scene, &scene.planes[number]);
        let view = found.theory.path().expect("a prediction by paths");
        tells_in(view, &scene, &photons, plane, faults);
    }
}
