//! Compares predicted and found variances at the planes of scenes.

use super::scene;
use crate::{
    MeasuredPower, Sampler, SamplerReport, VarianceError, WindowRadiance, WindowStudy,
    dyadic_power, with_box_window,
};
use etendue_scene::Scene;
use etendue_trace::Tracer;

const FEWER: (&str, &str) = ("photons: 4_194_304", "photons: 524_288");

/// Returns the reports of samplers at plane `index`, and the mean, σ² and noise of the radiance.
fn study(scene: &Scene, index: usize, counts: &[usize]) -> (Vec<SamplerReport>, [f64; 6]) {
    let max = 8;
    let scene = with_box_window(scene, index, max);
    let tracer = Tracer::new(&scene);
    let (plane, photons) = (&scene.planes[0], (&tracer as _, scene.run.batches));
    let power = MeasuredPower::measure(plane, photons, max, &|_| ()).unwrap();
    let bands = dyadic_power(plane, photons, &|_| ()).unwrap();
    let radiance = WindowRadiance::new(&scene).unwrap();
    let moments = radiance.moments(3, &|_| ());
    let off = power.mean.value - moments.mean.value;
    assert!(off.abs() < 4.0 * power.mean.error.hypot(moments.mean.error));
    let study = WindowStudy {
        power: &power,
        bands: Some(&bands),
        radiance: &radiance,
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
