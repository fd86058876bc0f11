//! Compares predicted and found variances at the planes of scenes.

use super::scene;
use crate::variance::power_estimate::jackknife_error;
use crate::variance::{
    LightPoints, MeasuredPower, Sampler, SamplerReport, VarianceError, WindowRadiance, WindowStudy,
    dyadic_power, with_box_window,
};
use etendue_field::{Crossing, PhotonSource, TwoPlane, VirtualPlane};
use etendue_scene::Scene;
use etendue_trace::Tracer;

/// The largest measured frequency.
const MAX: usize = 8;

const FEWER: (&str, &str) = ("photons: 4_194_304", "photons: 524_288");

/// The reports of samplers at plane `index`, and the mean, σ² and noise of the radiance.
fn study(scene: &Scene, index: usize, counts: &[usize]) -> (Vec<SamplerReport>, [f64; 6]) {
    let scene = with_box_window(scene, index, MAX);
    let radiance = WindowRadiance::new(&scene).unwrap();
    let photons = (&Tracer::new(&scene) as _, scene.run.batches);
    study_of(&scene.planes[0], photons, &radiance, counts)
}

fn study_of(
    plane: &VirtualPlane,
    photons: (&dyn PhotonSource, u32),
    radiance: &WindowRadiance<'_>,
    counts: &[usize],
) -> (Vec<SamplerReport>, [f64; 6]) {
    let power = MeasuredPower::measure(plane, photons, MAX, &|_| ()).unwrap();
    let bands = dyadic_power(plane, photons, &|_| ()).unwrap();
    let moments = radiance.moments(3, &|_| ());
    let (_, without) = power.spectrum.estimates(|power| power.iter().sum::<f64>());
    // With photons from lattices, the error would be 20 %.
    assert!(jackknife_error(&without) < 0.05 * moments.variance.value);
    let off = power.mean.value - moments.mean.value;
    assert!(off.abs() < 4.0 * power.mean.error.hypot(moments.mean.error));
    let study = WindowStudy {
        power: &power,
        bands: Some(&bands),
        radiance,
        moments: &moments,
        sets: 400,
        seed: 7,
    };
    let samplers = [
        Sampler::Independent,
        Sampler::Jitter,
        Sampler::LatinHypercube,
        Sampler::Sobol,
    ];
    let each = samplers.iter();
    let reports = each.map(|sampler| study.sampler(sampler, counts, &|_| ()));
    let numbers = [moments.mean, moments.variance, moments.noise].map(|m| [m.value, m.error]);
    (reports.collect(), numbers.concat().try_into().unwrap())
}

fn check(reports: &[SamplerReport]) {
    for report in reports {
        let unshifted = report.unshifted.iter().flat_map(|curve| &curve.counts);
        for count in report.shifted.counts.iter().chain(unshifted) {
            let off = (count.ratio.value - 1.0).abs() / count.ratio.error;
            assert!(off < 4.0, "{} {count:?}", report.sampler);
        }
    }
}

/// The mean of the soft shadow is a product of two areas: of the strip of (y, v) that sees the light
/// and of the part of the strip of (x, u) below the edge. The radiance is 0 or 1, so σ² is the mean
/// minus its square.
#[test]
fn a_soft_shadow_has_its_closed_form_and_its_error() {
    let (reports, [mean, mean_error, variance, variance_error, noise, _]) =
        study(&scene("soft_shadow.ron", &[FEWER]), 0, &[16, 256]);
    let steps = 1_000_000;
    let clipped = |t: f64| t.clamp(-0.25, 0.25);
    let [mut lit, mut all] = [0.0; 2];
    for i in 0..steps {
        let u = 0.2 * (2.0 * (f64::from(i) + 0.5) / f64::from(steps) - 1.0);
        let [low, high] = [2.0 * u - 0.25, 2.0 * u + 0.25].map(clipped);
        let edge = clipped(0.8 * u + 0.05);
        all += (high - low) / 0.5 / f64::from(steps);
        lit += (high.min(edge) - low).max(0.0) / 0.5 / f64::from(steps);
    }
    let exact = lit * all;
    assert!((mean - exact).abs() < 4.0 * mean_error, "{mean} {exact}");
    let off = variance - exact * (1.0 - exact);
    assert!(off.abs() < 4.0 * variance_error, "{variance} {exact}");
    assert!(noise.abs() < f64::MIN_POSITIVE);
    check(&reports);
}

/// A ray from the point s of the light to the point x of the floor passes the edge at 0.4 s + 0.6 x.
/// Without d² in the weights of photons, means by photons and by rays would differ.
#[test]
fn points_on_the_light_take_the_places_of_slopes() {
    let mut scene = with_box_window(&scene("soft_shadow.ron", &[FEWER]), 0, MAX);
    let points = LightPoints::new(&scene, MAX).unwrap();
    scene.planes = vec![points.seen.clone()];
    // The slopes of a ray follow from its point on the light.
    let ray = TwoPlane {
        x: 0.1,
        y: -0.2,
        u: 0.07,
        v: -0.15,
    };
    let moved = points.crossing(&Crossing { ray, weight: 1.0 }).ray;
    let back = points.ray(&moved);
    let off = [
        moved.u + 0.04,
        moved.v - 0.1,
        back.u - ray.u,
        back.v - ray.v,
    ];
    assert!(off.iter().all(|off| off.abs() < 1e-15), "{off:?}"); // rounding
    let photons = points.photons(Box::new(Tracer::new(&scene)));
    let radiance = points.radiance(WindowRadiance::new(&scene).unwrap());
    let (reports, [mean, mean_error, ..]) = study_of(
        &points.plane,
        (&*photons, scene.run.batches),
        &radiance,
        &[16, 256],
    );
    let steps = 1000;
    let place = |i: i32| 0.25 * (2.0 * (f64::from(i) + 0.5) / f64::from(steps) - 1.0);
    let pairs = (0..steps).flat_map(|i| (0..steps).map(move |j| (place(i), place(j))));
    let lit = pairs.filter(|(x, s)| 0.4 * s + 0.6 * x < 0.05).count();
    let exact = lit as f64 / f64::from(steps).powi(2);
    assert!((mean - exact).abs() < 4.0 * mean_error, "{mean} {exact}");
    check(&reports);
}

#[test]
fn points_on_the_light_need_an_area_and_the_first_leg() {
    let beyond = with_box_window(&scene("spot_disc.ron", &[FEWER]), 1, MAX);
    let point = with_box_window(&scene("glossy.ron", &[]), 0, MAX);
    for scene in [beyond, point] {
        assert!(matches!(
            LightPoints::new(&scene, MAX),
            Err(VarianceError::NoLightPoints { .. })
        ));
    }
}

/// Light that leaves a diffuse floor has noisy radiances, which add their noise to the variance.
#[test]
fn noise_of_radiances_is_part_of_the_variance() {
    let (reports, [.., noise, noise_error]) =
        study(&scene("spot_disc.ron", &[FEWER]), 1, &[16, 256]);
    assert!(noise > 10.0 * noise_error);
    check(&reports);
}

#[test]
fn a_point_has_no_radiance() {
    let light = "Spot(center: (0, 0, 0), bulb: Disc(0.3), radiance: 1.0, exponent: 40)";
    let scene = scene("spot_disc.ron", &[(light, "Point(center: (0, 0, 0))")]);
    let error = WindowRadiance::new(&with_box_window(&scene, 0, 8)).unwrap_err();
    assert_eq!(error, VarianceError::NoRadiance("receiver".to_owned()));
    assert!(WindowRadiance::new(&with_box_window(&scene, 1, 8)).is_ok());
}
