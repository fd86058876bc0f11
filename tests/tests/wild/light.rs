//! Tests scenes whose light once was sampled or predicted wrongly.

use super::{
    MORE, backward, by_exact_rays, by_path, by_theory, does_not_fail, edited,
    only_the_blind_are_wrong, photons, referred, replaced, report, row, scene, scene_does_not_fail,
    the_tracers_agree, verdict,
};
use etendue_compare::{Class, Verdict};
use etendue_field::{EnvironmentMap, LatLong, Light};
use etendue_predict::{Applicability, Theory, path};
use std::sync::Arc;

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
        let judged = report(&scene, &rays, plane, &by_exact_rays(&scene, plane));
        row(&scene, judged.class, "rays, as it is", 0.0, &judged);
        assert_eq!(judged.verdict, Verdict::Pass);
        let wrong = report(&scene, &rays, plane, &by_exact_rays(&wider, plane));
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
    let prediction = by_exact_rays(&scene, 0);
    assert_eq!(verdict(&scene, &rays, &prediction), Verdict::Pass);
    let mut view = path(&scene, plane).unwrap();
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
    let cut = by_path(&scene, 0, &view, prediction);
    assert_eq!(verdict(&scene, &rays, &cut), Verdict::Fail);
}

/// Rays sample the light from above even if most light of the sky arrives at low elevation.
#[test]
fn a_low_sky_is_decided() {
    let scene = scene("low_sky");
    scene_does_not_fail(&scene, Class::FirstOrder, "p");
}

/// The rays sample the sky's light that enters the window, even if light from behind is much
/// brighter.
#[test]
fn a_sky_from_behind_is_decided() {
    let scene = scene("sky_from_behind");
    only_the_blind_are_wrong(&scene, 0, |system| system.masks.clear());
}

/// Photons sampled in proportion to the sky's radiance rarely come from the direction of a lobe, so
/// some photons are sampled in proportion to the cosine. If only a few of the latter carry the
/// light, they do not contradict backward rays.
#[test]
fn a_dim_part_of_the_sky_is_found() {
    let few = scene("dim_lobe_of_a_sky");
    let reference = referred(&few, 0, &backward(&few));
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

/// Light of an environment starts in a plane, and both tracers find no light behind this plane.
#[test]
fn a_surface_behind_the_plane_of_the_sky_is_decided() {
    the_tracers_agree(&scene("behind_the_sky_plane"));
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

/// Only the tail of a projector's picture passes an edge: theory and backward rays find it.
#[test]
fn the_tail_of_a_projector_is_decided() {
    let scene = scene("tail_of_a_projector");
    let rays = backward(&scene);
    let prediction = by_theory(&scene, &scene.planes[0]);
    assert!(prediction.slices.at_zero() > 0.0, "theory finds the tail");
    assert_eq!(verdict(&scene, &rays, &prediction), Verdict::Pass);
}

/// A cosine after a diffuse reflection has no closed form.
#[test]
fn irradiance_after_a_floor_is_decided() {
    does_not_fail("irradiance_after_floor", Class::FirstOrder, "p");
}

/// Tests angles beyond a right angle: no light is found there, although there is light at these
/// angles minus a full turn.
#[test]
fn angles_beyond_a_turn_are_decided() {
    let scene = scene("angles_beyond_a_turn");
    let prediction = by_exact_rays(&scene, 0);
    for measured in [photons(&scene), backward(&scene)] {
        assert_eq!(verdict(&scene, &measured, &prediction), Verdict::Pass);
    }
}

/// The window is so narrow that hardly any ray aimed by the affine chain enters it. Exact rays that
/// are traced back from the window have almost no noise.
#[test]
fn a_narrow_window_is_decided() {
    for name in ["pinhole_beyond_glass", "pinhole_on_a_mirror"] {
        let scene = scene(name);
        let prediction = by_exact_rays(&scene, 0);
        let error = prediction.quadrature_error.unwrap();
        assert!(error < 0.01, "{name}, {error}: a tenth of the resolution");
        let judged = verdict(&scene, &backward(&scene), &prediction);
        assert_eq!(judged, Verdict::Pass, "{name}");
    }
}
