//! Tests, over many seeds, how `etendue diff` compares two measured results of one scene.

use crate::scenes::{fig9b, measured};
use crate::statistics::uniformity;
use etendue_compare::{Sample, TwoSamples, noise_dof};
use etendue_field::PhotonSource;
use etendue_scene::Scene;
use etendue_spectrum::estimate;
use etendue_trace::{Backward, Tracer};

/// The scene `fig9b` with few photons and few frequencies.
fn scene(seed: u64) -> Scene {
    let mut scene = fig9b(1 << 14, seed);
    for plane in &mut scene.planes {
        plane.grid.azimuths = 3;
        plane.grid.rho.half = plane.grid.rho.half.min(8);
        plane.grid.nu.half = plane.grid.nu.half.min(10);
    }
    scene
}

/// Returns, for each plane, the measured data in a result of `scene`.
fn samples(scene: &Scene, source: &dyn PhotonSource) -> Vec<Sample> {
    let measurement = measured(scene, source);
    let sample = |plane| {
        let slices = estimate::slices(&measurement, plane).expect("enough batches");
        Sample {
            mean: slices.mean.half,
            sigma: slices.variance.mapv(f64::sqrt),
            noise_dof: noise_dof(&measurement, plane).expect("enough batches"),
            batches: slices.batches,
        }
    };
    (0..scene.planes.len()).map(sample).collect()
}

fn photons(seed: u64) -> Vec<Sample> {
    let scene = scene(seed);
    samples(&scene, &Tracer::new(&scene))
}

fn backward(seed: u64) -> Vec<Sample> {
    let scene = scene(seed);
    samples(
        &scene,
        &Backward::new(&scene).expect("light that rays can find"),
    )
}

#[test]
#[ignore = "long: half a minute; .ci/long runs it"]
fn p_is_uniform_over_200_pairs_of_seeds() {
    let planes = scene(1).planes;
    let mut p = vec![Vec::new(); planes.len()];
    let mut across = p.clone();
    let mut planted = p.clone();
    for seed in 1..=200 {
        let a = photons(2 * seed);
        let b = photons(2 * seed + 1);
        // The noise of photons and the noise of backward rays differ in size and correlation.
        let c = backward(2 * seed + 1);
        for (i, plane) in planes.iter().enumerate() {
            let test = |other: &Sample| TwoSamples::new(&plane.grid, &a[i], other).p_value;
            p[i].extend(test(&b[i]));
            across[i].extend(test(&c[i]));
            // A planted fault: σ of one of the two results is 15 % too small.
            let mut small = b[i].clone();
            small.sigma *= 0.85;
            planted[i].extend(test(&small));
        }
    }
    for (plane, p) in planes.iter().zip(&planted) {
        assert!(
            uniformity(p) < 1e-3,
            "{}: a small σ is not noticed",
            plane.name
        );
    }
    for (name, all) in [("photons", &p), ("backward rays", &across)] {
        for (plane, p) in planes.iter().zip(all) {
            let uniform = uniformity(p);
            let low = p.iter().filter(|p| **p < 0.05).count();
            let line = format!(
                "{name} at {}: p of uniformity {uniform:.3}, {low} of 200 below 5 %",
                plane.name
            );
            // The level 0.1 % for each of ten tests gives 1 % for all.
            assert!(uniform > 1e-3, "{line}");
        }
    }
}
