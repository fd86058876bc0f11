//! Tests scenes in which obstacles once were missed.

use super::{
    by_exact_rays, by_path, by_theory, does_not_fail, edited, forgets_later_surfaces,
    only_the_blind_are_wrong, photons, replaced, report, scene, scene_does_not_fail,
    traced_backwards,
};
use etendue_compare::{Class, Verdict};
use etendue_predict::{Applicability, chain, path};

/// A prediction tests whether occluders block rays on the leg after the mirror.
#[test]
fn a_blocker_in_a_later_leg_is_decided() {
    masks_matter("blocker_in_later_leg");
}

/// A disc that shadows a ten-thousandth of the window is detected.
#[test]
fn a_small_disc_in_a_later_leg_is_decided() {
    masks_matter("corner_disc");
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

/// If squares cover a window perpendicular to the path, they still let light through to a window of
/// the same size on a surface.
#[test]
fn light_passes_beside_squares() {
    let scene = scene("squares_before_the_glass");
    let theory = Applicability::new(&scene, &scene.planes[0]);
    assert_eq!(theory.dark, None);
    assert!(photons(&scene).tally(0).inside > 1000);
}

/// In these scenes, only a few rays of the window meet the blockers, or meet a mesh that the path
/// visits later.
#[test]
#[ignore = "long: half a minute; .ci/long runs it"]
fn rays_of_a_brdf_meet_obstacles() {
    masks_matter("squares_on_the_way_back");
    let scene = scene("later_mesh");
    scene_does_not_fail(&scene, Class::FirstOrder, "p");
    only_the_blind_are_wrong(&scene, 0, forgets_later_surfaces);
}

/// A part of a mirror is nearer to the light than the mask. The window is so narrow that no ray
/// sampled from the light hits this part.
#[test]
fn a_sliver_of_slopes_is_decided() {
    does_not_fail("sliver_of_slopes", Class::FirstOrder, "p");
}

/// A wall beside the light extends behind the light, which emits only forward.
#[test]
fn a_wall_that_reaches_behind_the_light_is_decided() {
    does_not_fail("beside_the_light", Class::FirstOrder, "p");
}

/// A surface that the path visits later stands before the first surface, in a corner of the
/// window. Few of the projector's rays, which are sampled over all of a wide wall, reach the
/// corner of the window.
#[test]
fn a_later_surface_beside_the_first_leg_is_decided() {
    let scene = scene("beside_the_beam");
    only_the_blind_are_wrong(&scene, 0, forgets_later_surfaces);
}

/// A mirror is so close to the light that a part of the mirror is before the mask. Few rays that
/// are sampled from the light to the mirror hit this part.
#[test]
fn a_mirror_close_to_the_light_is_decided() {
    masks_matter("close_to_the_mirror");
}

/// A wall that the path visits later stands beside the first leg of the path.
#[test]
fn a_wall_in_the_way_is_decided() {
    only_the_chain_is_wrong("wall_in_the_way", Class::FirstOrder);
}

/// The chain after a floor uses the coordinates of the path, and not the coordinates of the wall to
/// which the path leads.
#[test]
fn a_plane_on_the_next_wall_is_decided() {
    only_the_chain_is_wrong("on_the_next_wall", Class::FirstOrder);
}

/// Checks that the prediction includes masks that only some rays meet, and that a prediction
/// without these masks is wrong.
fn masks_matter(name: &str) {
    let scene = scene(name);
    let plane = scene.planes.len() - 1;
    let backward = traced_backwards(&scene);
    let measured: Vec<_> = std::iter::once(photons(&scene)).chain(backward).collect();
    let right = by_exact_rays(&scene, plane);
    for measured in &measured {
        let report = report(&scene, measured, plane, &right);
        assert_ne!(
            report.verdict,
            Verdict::Fail,
            "{name}: {:?}",
            report.p_value
        );
    }
    let mut view = path(&scene, &scene.planes[plane]).unwrap();
    view.system.masks.clear();
    let without = by_path(&scene, plane, &view, right);
    let wrong = |measured| report(&scene, measured, plane, &without).verdict == Verdict::Fail;
    assert!(measured.iter().any(wrong), "{name}");
}

/// Checks that the only plane has the expected class of theory, and that the chain between
/// parallel planes is wrong.
fn only_the_chain_is_wrong(name: &str, class: Class) {
    let scene = scene(name);
    scene_does_not_fail(&scene, class, "p");
    let plane = &scene.planes[0];
    let slices = etendue_theory::slices(&chain(&scene, plane), &plane.window, &plane.grid);
    let wrong = replaced(by_exact_rays(&scene, 0), slices, Vec::new());
    let judged = report(&scene, &photons(&scene), 0, &wrong);
    assert_eq!(judged.verdict, Verdict::Fail, "{name}");
}

/// A flat mesh stops the light of a plane directly after it, but not of a plane directly before it.
#[test]
fn planes_at_a_square_are_decided() {
    let scene = scene("planes_at_a_square");
    let photons = photons(&scene);
    for (i, plane) in scene.planes.iter().enumerate() {
        let prediction = by_theory(&scene, plane);
        assert_eq!(
            report(&scene, &photons, i, &prediction).verdict,
            Verdict::Pass
        );
    }
}
