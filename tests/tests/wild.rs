//! Tests scenes for which theory once was wrong, stated too small an error, or gave no prediction
//! (results/wild.md).

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test that cannot go on should stop; what it prints is the table of results/wild.md"
)]

use etendue_compare::{
    Applicability, Class, PlaneReport, Prediction, Test, Theory, Verdict, chain, compare,
    scattered, system,
};
use etendue_field::{
    EnvironmentMap, LatLong, Light, PhotonSource, ProjectionGrid, Slices, VirtualPlane,
};
use etendue_scene::{Scene, SceneFile, resolve};
use etendue_spectrum::{Measurement, measure};
use etendue_theory::{Model, Observed, RayBudget, rays, scattering};
use etendue_trace::{Backward, Tracer};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/wild");

/// Returns a scene of `scenes/wild`, with parts of its text replaced.
fn edited(name: &str, edits: &[(&str, &str)]) -> Scene {
    let mut text = std::fs::read_to_string(format!("{FOLDER}/{name}.ron")).unwrap();
    for (from, to) in edits {
        assert!(text.contains(from), "{from} is not in {name}");
        text = text.replace(from, to);
    }
    let file = SceneFile::parse(&text).unwrap();
    resolve(name, file, FOLDER.as_ref(), u64::MAX).unwrap()
}

/// Returns a scene of `scenes/wild`.
fn scene(name: &str) -> Scene {
    edited(name, &[])
}

/// The number of photons in a scene file, and a larger number that replaces it. With the larger
/// number, many rays of each batch hit a bright pixel through the lobe.
const MORE: (&str, &str) = ("photons: 200_000", "photons: 2_000_000");

fn measured(scene: &Scene, source: &dyn PhotonSource) -> Measurement {
    measure(source, &scene.planes, 0..scene.run.batches, &|_| ())
}

fn photons(scene: &Scene) -> Measurement {
    measured(scene, &Tracer::new(scene))
}

fn backward(scene: &Scene) -> Measurement {
    measured(scene, &Backward::new(scene).unwrap())
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
        ..Test::of(scene)
    };
    let compared = compare(measurement, plane, prediction, &test);
    compared.unwrap().report
}

fn verdict(scene: &Scene, measurement: &Measurement, prediction: &Prediction) -> Verdict {
    report(scene, measurement, 0, prediction).verdict
}

fn by_theory(scene: &Scene, plane: &VirtualPlane) -> Prediction {
    Prediction::new(scene, plane, &Applicability::new(scene, plane))
}

fn by_reference(scene: &Scene, plane: usize, reference: &Measurement) -> Prediction {
    let theory = Applicability::new(scene, &scene.planes[plane]);
    Prediction::reference(scene, plane, &theory, reference, plane).unwrap()
}

/// Returns the prediction by exact rays, without the affine chain, whose verdict is separate.
fn as_it_is(scene: &Scene, plane: usize) -> Prediction {
    Prediction {
        first_order: None,
        ..by_theory(scene, &scene.planes[plane])
    }
}

/// Returns the row of results/wild.md that describes a plane.
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

/// Checks that every plane of a scene has the expected class of theory, and that no verdict is a
/// failure. Photons decide the verdict on each plane; if they are undecided and a backward tracer
/// exists, backward rays decide.
fn holds(name: &str, planes: &[(&str, Class)]) {
    holds_in(&scene(name), planes);
}

fn holds_in(scene: &Scene, planes: &[(&str, Class)]) {
    let name = &scene.name;
    let by_photons = photons(scene);
    let by_rays = Backward::new(scene).ok();
    let by_rays = by_rays.map(|source| measured(scene, &source));
    assert_eq!(scene.planes.len(), planes.len(), "{name}");
    for (i, (plane, (called, class))) in scene.planes.iter().zip(planes).enumerate() {
        assert_eq!(plane.name, *called);
        let found = Applicability::new(scene, plane).class();
        assert_eq!(found, *class, "{name}: {called}");
        let begun = Instant::now();
        let prediction = match class {
            Class::Reference => by_reference(scene, i, by_rays.as_ref().unwrap()),
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

#[test]
fn scenes_that_took_long_have_an_answer() {
    use Class::{Exact, FirstOrder};
    holds(
        "square_rectangle_disc_grating",
        &[
            ("leaving", Exact),
            ("on_its_way", Exact),
            ("farther", Exact),
        ],
    );
    let behind = [
        ("outgoing", FirstOrder),
        ("beyond", FirstOrder),
        ("farther", FirstOrder),
    ];
    holds("two_arrays_interface", &behind);
    holds("projector_halfplane_beckmann", &behind);
    let on_and_off = [("reflection", FirstOrder), ("outgoing", FirstOrder)];
    holds("big_map", &on_and_off);
}

/// A fine mesh deviates from the patch that osculates it by more than the noise of photon nets. The
/// stated error of the prediction includes this deviation; without it, the scene fails.
#[test]
fn a_mesh_beside_its_patch_is_no_disagreement() {
    let folder = Path::new(FOLDER).join("../table1");
    let text = std::fs::read_to_string(folder.join("mesh_mirror.ron")).unwrap();
    let file = SceneFile::parse(&text).unwrap();
    let scene = resolve("mesh_mirror", file, &folder, u64::MAX).unwrap();
    let photons = photons(&scene);
    for (i, plane) in scene.planes.iter().enumerate() {
        let prediction = by_theory(&scene, plane);
        let verdict = |p: &Prediction| report(&scene, &photons, i, p).verdict;
        assert_eq!(verdict(&prediction), Verdict::Pass, "{}", plane.name);
        let error = prediction.mesh_error.unwrap_or(0.0);
        assert!(error < 1e-4, "{error:e} at {}", plane.name); // the error for photons is 10⁻⁵
        let unaware = Prediction {
            mesh_error: Some(1e-6),
            ..prediction
        };
        let fails = verdict(&unaware) == Verdict::Fail;
        assert_eq!(fails, i > 0, "{}", plane.name); // before the first plane, nothing is reflected
    }
}

/// The stated error for the triangles of a mesh equals the deviation of photons.
#[test]
#[ignore = "long: half a minute; .ci/long runs it"]
fn triangles_are_as_far_off_as_is_stated() {
    let scene = scene("coarse_paraboloid");
    let photons = photons(&scene);
    let prediction = by_theory(&scene, &scene.planes[0]);
    let judged = report(&scene, &photons, 0, &prediction);
    assert_eq!(judged.verdict, Verdict::Pass);
    let [stated, seen] = [prediction.mesh_error, judged.excess].map(Option::unwrap);
    let ratio = stated / seen;
    // The stated error is a sampled value plus its standard error. The observed error has a
    // standard error of a fifth of its value.
    assert!(
        (1.0..1.3).contains(&ratio),
        "{stated:e} stated, {seen:e} seen"
    );
    let unaware = Prediction {
        mesh_error: Some(0.4 * stated),
        ..prediction
    };
    let judged = report(&scene, &photons, 0, &unaware);
    assert_eq!(judged.verdict, Verdict::Fail);
}

#[test]
fn scenes_that_were_refused_have_an_answer() {
    let behind = [("outgoing", Class::FirstOrder)];
    holds("many_squares_mirror", &behind);
    holds("many_squares_glossy", &behind);
    let in_a_row = ["leaving_wall", "at_floor", "beyond"].map(|plane| (plane, Class::FirstOrder));
    holds("sky_on_walls", &in_a_row);
    holds("sky_on_both_sides", &[("leaving", Class::FirstOrder)]);
}

#[test]
fn scenes_that_were_wrong_do_not_fail() {
    use Class::{Exact, FirstOrder, Reference};
    holds("fine_grating_floor", &[("leaving", Exact)]);
    holds("wide_gaussian_sky", &[("outgoing", FirstOrder)]);
    holds("leaning_mesh", &[("on_it", FirstOrder)]);
    holds("at_a_tilted_sky", &[("sky", FirstOrder)]);
    let both_sides = [("arriving", FirstOrder), ("leaving", FirstOrder)];
    holds("mask_beside_a_tilted_glass", &both_sides);
    let legs = [("outgoing", FirstOrder), ("beyond", FirstOrder)];
    holds("blocker_in_later_leg", &legs);
    let twice = [("outgoing", Reference), ("beyond", Reference)];
    holds("hollow_twice", &twice);
    let shadowed = [("reflection", FirstOrder), ("outgoing", FirstOrder)];
    holds("self_shadow", &shadowed);
    let dark = [("incidence", FirstOrder), ("outgoing", FirstOrder)];
    holds("projector_two_occluders", &dark);
}

/// The first-order chain is computed as the exact prediction plus a difference. Therefore it has
/// the noise of the exact prediction.
#[test]
fn the_chain_of_a_small_map_does_not_fail() {
    use Class::FirstOrder;
    let planes = [("reflection", FirstOrder), ("outgoing", FirstOrder)];
    holds_in(&edited("small_map_phong", &[MORE]), &planes);
}

/// Nets of rays resolve a grating, but the quadrature nodes on a receiver do not. A prediction that
/// uses these nodes is still wrong.
#[test]
fn a_fine_grating_is_decided() {
    let scene = scene("fine_grating_floor");
    let (photons, plane) = (photons(&scene), &scene.planes[0]);
    let prediction = by_theory(&scene, plane);
    assert!(!prediction.replicates.is_empty(), "nets predict it");
    assert_eq!(verdict(&scene, &photons, &prediction), Verdict::Pass);
    let Theory::Parallel(chain) = Applicability::new(&scene, plane).theory else {
        panic!("a chain between parallel planes")
    };
    let by_nodes = replaced(
        prediction,
        etendue_theory::slices(&chain, &plane.window, &plane.grid),
        Vec::new(),
    );
    assert_eq!(verdict(&scene, &photons, &by_nodes), Verdict::Fail);
}

/// A narrow lobe reflects an environment map with few pixels. One plane is on the surface, and one
/// is after it. Photons reject a lobe that is a fifth wider.
#[test]
fn a_small_map_is_decided() {
    let scene = edited("small_map_phong", &[MORE]);
    let wider = edited("small_map_phong", &[MORE, ("Phong(400)", "Phong(278)")]);
    let rays = backward(&scene);
    for plane in 0..scene.planes.len() {
        let judged = report(&scene, &rays, plane, &as_it_is(&scene, plane));
        row(&scene, judged.class, "rays, as it is", 0.0, &judged);
        assert_eq!(judged.verdict, Verdict::Pass);
        let wrong = report(&scene, &rays, plane, &as_it_is(&wider, plane));
        assert_eq!(wrong.verdict, Verdict::Fail);
    }
}

/// Number of widths beyond which the tail of a sky lobe was once treated as dark.
const CUT: f64 = 5.0;

/// The tail of a wide sky lobe contributes light, and photons reject a prediction without this
/// tail.
#[test]
fn a_wide_glow_is_decided() {
    let scene = scene("wide_gaussian_sky");
    let plane = &scene.planes[0];
    let rays = backward(&scene);
    let prediction = as_it_is(&scene, 0);
    assert_eq!(verdict(&scene, &rays, &prediction), Verdict::Pass);
    let mut view = scattered(&scene, plane).unwrap();
    let Light::Environment { environment } = &mut view.system.light else {
        panic!("an environment")
    };
    let EnvironmentMap::Lobes(lobes) = &environment.map else {
        panic!("a sum of lobes")
    };
    let lobe = lobes[0];
    let glow = environment.map.clone();
    environment.map = EnvironmentMap::LatLong(Arc::new(LatLong::from_fn(512, 256, |from| {
        let angle = from.dot(lobe.from.normalize()).clamp(-1.0, 1.0).acos();
        let seen = angle < CUT * lobe.width;
        if seen { glow.radiance(from) } else { 0.0 }
    })));
    let cut = by_scattering(&scene, &view, prediction);
    assert_eq!(verdict(&scene, &rays, &cut), Verdict::Fail);
}

/// A prediction tests whether occluders behind the mirror block its rays.
#[test]
fn a_blocker_in_a_later_leg_is_decided() {
    is_followed_past("blocker_in_later_leg", &["edge"]);
}

/// A disc that shadows a ten-thousandth of the window is detected.
#[test]
fn a_small_disc_in_a_later_leg_is_decided() {
    is_followed_past("corner_disc", &["disc"]);
}

/// In theory, a ray meets a surface only once. Therefore backward rays replace theory for light
/// that meets the surface twice.
#[test]
fn a_hollow_met_twice_is_decided() {
    let scene = edited("hollow_twice", &[MORE]);
    for plane in 0..2 {
        decided_by_reference(&scene, plane, |scene, reference| {
            by_specular(scene, plane, reference)
        });
    }
}

/// Backward rays also replace theory if one side of a surface blocks light of the other side.
#[test]
fn a_surface_in_its_own_shadow_is_decided() {
    let scene = scene("self_shadow");
    for plane in 0..2 {
        decided_by_reference(&scene, plane, |scene, reference| {
            let view = scattered(scene, &scene.planes[plane]).unwrap();
            by_scattering(scene, &view, reference)
        });
    }
}

/// Checks that both tracers agree with each other. They must disagree with a prediction by
/// `theory`, which does not apply.
fn decided_by_reference(
    scene: &Scene,
    plane: usize,
    theory: impl Fn(&Scene, Prediction) -> Prediction,
) {
    let found = Applicability::new(scene, &scene.planes[plane]);
    assert!(!found.reasons.is_empty() || !found.declined.is_empty());
    let (photons, rays) = (photons(scene), backward(scene));
    let reference = by_reference(scene, plane, &rays);
    let judged = report(scene, &photons, plane, &reference);
    assert_eq!(judged.verdict, Verdict::Pass);
    let regardless = theory(scene, reference);
    let wrong = report(scene, &photons, plane, &regardless);
    assert_eq!(wrong.verdict, Verdict::Fail);
}

/// If there is no gap between two half-planes, they are reported as the cause of a dark plane. If
/// there is a gap, they are not reported.
#[test]
fn darkness_behind_two_occluders_is_decided() {
    let scene = scene("projector_two_occluders");
    let open = edited("projector_two_occluders", &[("edge: 0.02", "edge: -0.02")]);
    let [dark, lit] = [&scene, &open].map(photons);
    for (plane, at) in scene.planes.iter().enumerate() {
        let reason = Applicability::new(&scene, at).dark.unwrap();
        assert!(reason.contains("below and above"), "{reason}");
        let prediction = by_theory(&scene, at);
        let judged = report(&scene, &dark, plane, &prediction);
        assert_eq!(judged.verdict, Verdict::Pass);
        assert!(
            Applicability::new(&open, &open.planes[plane])
                .dark
                .is_none()
        );
        let wrong = report(&open, &lit, plane, &prediction);
        assert_eq!(wrong.verdict, Verdict::Fail);
    }
}

/// Budget with which a prediction has an error of half a per cent in each of these scenes.
const BUDGET: RayBudget = RayBudget {
    nodes: 1e6,
    error: 5e-3,
};

fn by_specular(scene: &Scene, plane: usize, like: Prediction) -> Prediction {
    let view = system(scene, &scene.planes[plane]).unwrap();
    by_rays(scene, plane, &view, like)
}

fn by_rays(
    scene: &Scene,
    plane: usize,
    view: &Observed<rays::SpecularSystem>,
    like: Prediction,
) -> Prediction {
    let plane = &scene.planes[plane];
    let picture = ProjectionGrid::new(&plane.window, 1);
    let over = (&plane.window, &plane.grid, &picture);
    let found = view.predict(&[], over, BUDGET);
    replaced(like, found.slices, found.replicates)
}

fn by_scattering(
    scene: &Scene,
    view: &Observed<scattering::ScatteringSystem>,
    like: Prediction,
) -> Prediction {
    let grid = like.slices.grid;
    let window = &scene.planes[0].window;
    let picture = ProjectionGrid::new(window, 1);
    let over = (window, &grid, &picture);
    let found = view.predict(&[], over, BUDGET);
    replaced(like, found.slices, found.replicates)
}

/// Returns a prediction with its slices replaced by others.
fn replaced(like: Prediction, slices: Slices, replicates: Vec<Slices>) -> Prediction {
    Prediction {
        quadrature_error: None,
        mesh_error: None,
        slices,
        replicates,
        ..like
    }
}

/// If squares cover a window perpendicular to the path, they still let light through to a window of
/// the same size on a surface.
#[test]
fn what_goes_by_squares_is_decided() {
    let scene = scene("squares_before_the_glass");
    let theory = Applicability::new(&scene, &scene.planes[0]);
    assert_eq!(theory.dark, None);
    assert!(photons(&scene).tally(0).inside > 1000);
}

/// Rays sample the light from above even if most light of the sky arrives at low elevation.
#[test]
fn a_low_sky_is_decided() {
    let scene = scene("low_sky");
    let declined = Applicability::new(&scene, &scene.planes[0]).declined;
    assert_eq!(declined, ["light that meets glass out of order"]);
    // A ray of the prediction ends if it meets the glass in another order than the path does.
    holds_in(&scene, &[("p", Class::FirstOrder)]);
}

/// In these scenes, rays that leave the triangles of a mesh meet the mesh again, or take another
/// direction. Rays that leave the patch that osculates the mesh do not.
#[test]
fn meshes_unlike_their_patches_are_decided() {
    let glass = scene("glass_star");
    let theory = Applicability::new(&glass, &glass.planes[0]);
    assert_eq!(theory.class(), Class::Reference, "{:?}", theory.reasons);
    assert_eq!(photons(&glass).tally(0).inside, 0);

    for name in ["ball_beyond_its_patch", "somewhat_coarse_mesh"] {
        let scene = scene(name);
        let theory = Applicability::new(&scene, &scene.planes[0]);
        assert_eq!(theory.class(), Class::Reference, "{:?}", theory.reasons);
        let measured = photons(&scene);
        let reference = by_reference(&scene, 0, &self::measured(&scene, &Tracer::evenly(&scene)));
        let judged = report(&scene, &measured, 0, &reference);
        assert_eq!(judged.verdict, Verdict::Pass, "{name}");
        let regardless = by_specular(&scene, 0, reference);
        let wrong = report(&scene, &measured, 0, &regardless);
        assert_eq!(wrong.verdict, Verdict::Fail, "{name}");
    }
}

/// In these scenes, only a few rays of the window meet the blockers, or meet a mesh that the path
/// visits later.
#[test]
#[ignore = "long: half a minute; .ci/long runs it"]
fn what_stands_in_the_way_of_a_brdf_is_decided() {
    is_followed_past("squares_on_the_way_back", &["squares"]);
    let scene = scene("later_mesh");
    holds_in(&scene, &[("p", Class::FirstOrder)]);
    decided_by_reference(&scene, 0, |scene, reference| {
        let view = scattered(scene, &scene.planes[0]).unwrap();
        by_scattering(scene, &view, reference)
    });
}

/// Checks that the prediction includes obstacles that only some rays meet, and that a prediction
/// without these obstacles is wrong.
fn is_followed_past(name: &str, obstacles: &[&str]) {
    let scene = scene(name);
    let plane = scene.planes.len() - 1;
    let backward = Backward::new(&scene).ok();
    let backward = backward.map(|source| measured(&scene, &source));
    let measured: Vec<_> = std::iter::once(photons(&scene)).chain(backward).collect();
    let theory = Applicability::new(&scene, &scene.planes[plane]).theory;
    let right = as_it_is(&scene, plane);
    for measured in &measured {
        let report = report(&scene, measured, plane, &right);
        assert_ne!(
            report.verdict,
            Verdict::Fail,
            "{name}: {:?}",
            report.p_value
        );
    }
    let (found, without) = match theory {
        Theory::Specular(view) => {
            let found = view.system.obstacles;
            let mut view = system(&scene, &scene.planes[plane]).unwrap();
            view.system.obstacles.clear();
            (found, by_rays(&scene, plane, &view, right))
        }
        Theory::Scattering(view) => {
            let found = view.system.obstacles;
            let mut view = scattered(&scene, &scene.planes[plane]).unwrap();
            view.system.obstacles.clear();
            (found, by_scattering(&scene, &view, right))
        }
        other => panic!("{name}: {other:?}"),
    };
    let found: Vec<&str> = found
        .iter()
        .map(|obstacle| obstacle.name.as_str())
        .collect();
    assert_eq!(found, obstacles, "{name}");
    let wrong = |measured| report(&scene, measured, plane, &without).verdict == Verdict::Fail;
    assert!(measured.iter().any(wrong), "{name}");
}

/// A part of a mirror is nearer to the light than the mask. The window is so narrow that no ray
/// sampled from the light hits this part.
#[test]
fn a_sliver_of_slopes_is_decided() {
    is_followed_past("sliver_of_slopes", &["slit"]);
}

/// A surface that is convex towards a point light does not shadow its own tangent plane.
#[test]
fn a_plane_behind_its_surface_is_decided() {
    let scene = scene("before_a_trough");
    let reference = by_reference(&scene, 0, &backward(&scene));
    assert_eq!(verdict(&scene, &photons(&scene), &reference), Verdict::Pass);
}

/// A wall beside the light extends behind the light, which emits only forward.
#[test]
fn a_wall_that_reaches_behind_the_light_is_decided() {
    holds("beside_the_light", &[("p", Class::FirstOrder)]);
}

/// A surface that the path visits later stands before the first surface, in a corner of the
/// window. Few of the projector's rays, which are sampled over all of a wide wall, reach the
/// corner of the window.
#[test]
fn a_later_surface_beside_the_first_leg_is_decided() {
    let scene = scene("beside_the_beam");
    decided_by_reference(&scene, 0, |scene, reference| {
        by_specular(scene, 0, reference)
    });
}

/// Tests angles beyond a right angle: no light is found there, although there is light at these
/// angles minus a full turn.
#[test]
fn angles_beyond_a_turn_are_decided() {
    let scene = scene("angles_beyond_a_turn");
    let prediction = as_it_is(&scene, 0);
    for measured in [photons(&scene), backward(&scene)] {
        assert_eq!(verdict(&scene, &measured, &prediction), Verdict::Pass);
    }
}

/// A mirror is so close to the light that a part of the mirror is before the mask. Few rays that
/// are sampled from the light to the mirror hit this part.
#[test]
fn a_mirror_close_to_the_light_is_decided() {
    is_followed_past("close_to_the_mirror", &["mask"]);
}

/// The rays sample the sky's light that enters the window, even if light from behind is much
/// brighter.
#[test]
fn a_sky_from_behind_is_decided() {
    let scene = scene("sky_from_behind");
    decided_by_reference(&scene, 0, |scene, reference| {
        let view = scattered(scene, &scene.planes[0]).unwrap();
        by_scattering(scene, &view, reference)
    });
}

/// A surface may curve by more than a right angle. Photons are then recorded where they first meet
/// the surface, and have the same coordinates there as backward rays.
#[test]
fn a_ridge_under_a_sky_is_decided() {
    let scene = scene("ridge_under_a_sky");
    let reference = by_reference(&scene, 0, &backward(&scene));
    assert_eq!(verdict(&scene, &photons(&scene), &reference), Verdict::Pass);
}

/// A discontinuous window cuts the light of a projector. For such light, two quadratures with few
/// rays may agree by chance.
#[test]
fn a_box_before_a_projector_is_decided() {
    let scene = scene("box_before_a_projector");
    let prediction = by_theory(&scene, &scene.planes[0]);
    assert!(!prediction.replicates.is_empty(), "nets predict it");
    assert_eq!(
        verdict(&scene, &photons(&scene), &prediction),
        Verdict::Pass
    );
}

/// A cosine after a diffuse reflection has no closed form.
#[test]
fn irradiance_after_a_floor_is_decided() {
    holds("irradiance_after_floor", &[("p", Class::FirstOrder)]);
}

/// A wall that the path visits later stands beside the first leg of the path.
#[test]
fn a_wall_in_the_way_is_decided() {
    decided_against_chain("wall_in_the_way", Class::Reference);
}

/// The chain after a floor uses the coordinates of the path, and not the coordinates of the wall to
/// which the path leads.
#[test]
fn a_plane_on_the_next_wall_is_decided() {
    decided_against_chain("on_the_next_wall", Class::FirstOrder);
}

/// Checks that the only plane has the expected class of theory, and that the chain between
/// parallel planes is wrong.
fn decided_against_chain(name: &str, class: Class) {
    let scene = scene(name);
    holds_in(&scene, &[("p", class)]);
    decided_by_reference(&scene, 0, |scene, reference| {
        let plane = &scene.planes[0];
        let slices = etendue_theory::slices(&chain(scene, plane), &plane.window, &plane.grid);
        replaced(reference, slices, Vec::new())
    });
}

/// If the line of a ray meets a hollow surface again, its light is not counted, even if a blocker
/// stops it before the surface. Light that meets a floor inside the hollow surface continues from
/// the floor.
#[test]
fn light_that_would_meet_its_surface_again_is_decided() {
    for name in ["stopped_in_a_hollow", "floor_in_a_hollow"] {
        let scene = edited(name, &[MORE]);
        let reference = by_reference(&scene, 0, &backward(&scene));
        let judged = verdict(&scene, &photons(&scene), &reference);
        assert_eq!(judged, Verdict::Pass, "{name}");
    }
}

/// The window is so narrow that hardly any ray aimed by the affine chain enters it. Exact rays that
/// are traced back from the window have almost no noise.
#[test]
fn a_narrow_window_is_decided() {
    for name in ["pinhole_beyond_glass", "pinhole_on_a_mirror"] {
        let scene = scene(name);
        let prediction = as_it_is(&scene, 0);
        let error = prediction.quadrature_error.unwrap();
        assert!(error < 0.01, "{name}, {error}: a tenth of the resolution");
        let judged = verdict(&scene, &backward(&scene), &prediction);
        assert_eq!(judged, Verdict::Pass, "{name}");
    }
}

/// Photons sampled in proportion to the sky's radiance rarely come from the direction of a lobe, so
/// some photons are sampled in proportion to the cosine. If only a few of the latter carry the
/// light, they do not contradict backward rays.
#[test]
fn a_dim_part_of_the_sky_is_found() {
    let few = scene("dim_lobe_of_a_sky");
    let reference = by_reference(&few, 0, &backward(&few));
    let judged = verdict(&few, &photons(&few), &reference);
    assert_eq!(judged, Verdict::Undecided);
    let many = edited("dim_lobe_of_a_sky", &[MORE]);
    let [found, there] = [photons(&many), backward(&many)].map(|measured| {
        let batches = measured.at_plane(0).map(|batch| batch.slices.at_zero());
        batches.sum::<f64>()
    });
    // If some photons are sampled in proportion to the cosine, the noise is 15 %. Without such
    // photons, only 10⁻⁹ of the light is found.
    assert!((found / there - 1.0).abs() < 0.5, "{found} of {there}");
}

/// A plane on the second surface of a path, after a surface with a BRDF, uses the coordinates of
/// the second surface.
#[test]
fn a_plane_before_a_second_surface_is_decided() {
    let planes = [("tangent", Class::FirstOrder), ("local", Class::FirstOrder)];
    holds("before_second_after_brdf", &planes);
}

/// If light meets a mesh from behind, the ratio of the mesh's indices of refraction is inverted.
#[test]
fn a_mesh_met_from_behind_is_decided() {
    let turned = edited(
        "mesh_refraction_from_behind",
        &[("front: 1, back: 1.5", "front: 1.5, back: 1")],
    );
    let scene = scene("mesh_refraction_from_behind");
    let measured = photons(&scene);
    assert_eq!(
        verdict(&scene, &measured, &as_it_is(&scene, 0)),
        Verdict::Pass
    );
    assert_eq!(
        verdict(&scene, &measured, &as_it_is(&turned, 0)),
        Verdict::Fail
    );
}

/// Light of an environment starts in a plane, and both tracers find no light behind this plane.
#[test]
fn a_surface_behind_the_plane_of_the_sky_is_decided() {
    let scene = scene("behind_the_sky_plane");
    let reference = by_reference(&scene, 0, &backward(&scene));
    assert_eq!(verdict(&scene, &photons(&scene), &reference), Verdict::Pass);
}

/// Normals of a mesh are interpolated, so a coarse mesh is not a smooth surface.
#[test]
fn a_coarse_mesh_is_decided() {
    let area = [
        ("Beam(", "Rectangle("),
        ("image: (width: (0.01, 0.01))", "size: (0.01, 0.01)"),
    ];
    holds_in(
        &edited("coarse_mesh_mirror", &area),
        &[("p", Class::Reference)],
    );
}

/// A plane on a thin lens has no affine chain, but a plane beyond the lens has one. Exact rays are
/// correct on the lens and beyond it.
#[test]
fn a_plane_on_a_lens_is_decided() {
    let scene = scene("on_a_lens");
    let measured = photons(&scene);
    for (plane, has_chain) in [(0, false), (1, true)] {
        let prediction = by_theory(&scene, &scene.planes[plane]);
        assert_eq!(prediction.first_order.is_some(), has_chain);
        let judged = report(&scene, &measured, plane, &prediction);
        assert_eq!(judged.verdict, Verdict::Pass, "{judged:?}");
    }
}
