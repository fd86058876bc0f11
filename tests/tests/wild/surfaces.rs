//! Tests scenes whose surfaces once were followed wrongly.

use super::{
    MORE, both_tracers_agree_with_theory, by_exact_rays, by_path, by_theory, edited,
    forgets_own_shadows, only_the_blind_are_wrong, photons, referred, report, scene,
    scene_does_not_fail, the_tracers_agree, verdict,
};
use crate::common;
use crate::scenes::traced_evenly;
use etendue_compare::{Class, Prediction, Verdict};
use etendue_predict::{Applicability, path};

/// A fine mesh deviates from the patch that osculates it by more than the noise of photon nets. The
/// stated error of the prediction includes this deviation; without it, the scene fails.
#[test]
fn the_error_of_a_fine_mesh_is_stated() {
    let scene = common::edited("table1/mesh_mirror", &[]);
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
fn the_stated_error_of_triangles_is_right() {
    let more = ("photons: 10_000_000", "photons: 40_000_000");
    let scene = edited("coarse_paraboloid", &[more]);
    let photons = photons(&scene);
    let prediction = by_theory(&scene, &scene.planes[0]);
    let judged = report(&scene, &photons, 0, &prediction);
    assert_eq!(judged.verdict, Verdict::Pass);
    let [stated, seen] = [prediction.mesh_error, judged.excess].map(Option::unwrap);
    // The stated error is a sampled value plus its standard error, so that it may be larger than
    // the observed error, but smaller only by the noise of the photons.
    let noise = 0.5 * judged.excess_squared_error.unwrap() / (seen * seen);
    assert!(noise < 0.06, "{noise}"); // with fewer photons, this test would see little
    let ratio = stated / seen;
    assert!(
        (1.0 - 2.0 * noise..1.3).contains(&ratio),
        "{stated:e} stated, {seen:e} seen, ± {noise:.3}"
    );
    let unaware = Prediction {
        mesh_error: Some(0.4 * stated),
        ..prediction
    };
    let judged = report(&scene, &photons, 0, &unaware);
    assert_eq!(judged.verdict, Verdict::Fail);
}

/// Light that meets a hollow mirror twice is lost, for theory as for photons.
#[test]
fn a_hollow_met_twice_is_decided() {
    let scene = edited("hollow_twice", &[MORE]);
    for plane in 0..2 {
        only_the_blind_are_wrong(&scene, plane, forgets_own_shadows);
    }
}

/// One side of a surface blocks light of the other side.
#[test]
fn a_surface_in_its_own_shadow_is_decided() {
    let scene = scene("self_shadow");
    // No light of the second plane's window would come from the shadow.
    only_the_blind_are_wrong(&scene, 0, forgets_own_shadows);
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
        let reference = referred(&scene, 0, &traced_evenly(&scene));
        let judged = report(&scene, &measured, 0, &reference);
        assert_eq!(judged.verdict, Verdict::Pass, "{name}");
        let view = path(&scene, &scene.planes[0]).unwrap();
        let regardless = by_path(&scene, 0, &view, reference);
        let wrong = report(&scene, &measured, 0, &regardless);
        assert_eq!(wrong.verdict, Verdict::Fail, "{name}");
    }
}

/// A surface that is convex towards a point light does not shadow its own tangent plane.
#[test]
fn a_plane_behind_its_surface_is_decided() {
    the_tracers_agree(&scene("before_a_trough"));
}

/// A surface may curve by more than a right angle. Photons are then recorded where they first meet
/// the surface, and have the same coordinates there as backward rays.
#[test]
fn a_ridge_under_a_sky_is_decided() {
    the_tracers_agree(&scene("ridge_under_a_sky"));
}

/// If the line of a ray meets a hollow surface again, its light is not counted, even if a blocker
/// stops it before the surface. Light that meets a floor inside the hollow surface continues from
/// the floor.
#[test]
fn light_does_not_meet_its_surface_again() {
    for name in ["stopped_in_a_hollow", "floor_in_a_hollow"] {
        the_tracers_agree(&edited(name, &[MORE]));
    }
}

/// A plane on the second surface of a path, after a surface with a BRDF, uses the coordinates of
/// the second surface.
#[test]
fn a_plane_before_a_second_surface_is_decided() {
    let scene = scene("before_second_after_brdf");
    scene_does_not_fail(&scene, Class::FirstOrder, "tangent local");
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
        verdict(&scene, &measured, &by_exact_rays(&scene, 0)),
        Verdict::Pass
    );
    assert_eq!(
        verdict(&scene, &measured, &by_exact_rays(&turned, 0)),
        Verdict::Fail
    );
}

/// Normals of a mesh are interpolated, so a coarse mesh is not a smooth surface.
#[test]
fn a_coarse_mesh_is_decided() {
    let area = [
        ("Beam(", "Rectangle("),
        ("image: (width: (0.01, 0.01))", "size: (0.01, 0.01)"),
    ];
    let scene = edited("coarse_mesh_mirror", &area);
    scene_does_not_fail(&scene, Class::Reference, "p");
}

/// The triangles of a roof turn light about interpolated normals, which does not conserve étendue.
/// Backward rays that leave this out are 7 % off.
#[test]
fn a_roof_with_interpolated_normals_is_decided() {
    the_tracers_agree(&scene("roof"));
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

/// The plane of the second surface cuts the first one, a diffuse wall or a mirror. Where the plane
/// lies behind the first surface, photons, backward rays and theory find no light.
#[test]
fn a_plane_that_cuts_the_surface_before_it_is_decided() {
    let scene = scene("through_the_wall_before");
    both_tracers_agree_with_theory(&scene);
    let mirror = [
        ("Rectangle(", "Smooth(facing: (0, 0.05, -1), form: Plane, "),
        ("size: (1, 4), albedo: 1)", "aperture: 2, event: Mirror)"),
        ("from: (0, 0, 1)", "from: (0, 0, -1)"),
    ];
    the_tracers_agree(&edited("through_the_wall_before", &mirror));
}

/// A plane cuts the wall that light leaves. Paths that are aimed at the plane miss the part of the wall
/// beyond it, which also counts.
#[test]
fn a_wall_beyond_the_plane_is_decided() {
    let scene = scene("wall_beyond_the_plane");
    both_tracers_agree_with_theory(&scene);
}
