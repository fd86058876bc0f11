//! Tests that lattices estimate spectra without bias and with less noise than random numbers.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use etendue_field::{Crossing, PhotonSource};
use etendue_scene::{Sampling, Scene, SceneFile, resolve};
use etendue_trace::Tracer;
use std::f64::consts::TAU;

/// A square light behind bars, seen at two planes.
const SCENE: &str = r#"(
    light: Rectangle(center: (0, 0, 0), size: (0.5, 0.3)),
    blockers: [Bars(name: "bars", center: (0.03, 0, 1), axis: X, count: 5, pitch: 0.2, fill: 0.5)],
    surfaces: [Rectangle(name: "floor", center: (0, 0, 2), size: (4, 4))],
    path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["floor"]),
    planes: [(name: "near", at: Before("bars")), (name: "far", at: Distance(1.9))],
    window: (x: Hann(0.4), u: Hann(0.3)),
    frequencies: (azimuths: 4, rho: (max: 12), nu: (max: 12)),
    run: (photons: 640_000, batches: 64),
)"#;

/// Frequencies (ρ, ν) along x, y, u and v, at two azimuths.
const FREQUENCIES: [[f64; 4]; 5] = [
    [0.0; 4],
    [3.0, 0.0, 2.0, 0.0],
    [9.0, 0.0, -8.0, 0.0],
    [0.0, 4.0, 0.0, -6.0],
    [0.0, 11.0, 0.0, 3.0],
];

/// The mean over the batches of each Fourier coefficient of each plane, and the variance of
/// this mean.
fn coefficients(scene: &Scene) -> Vec<[f64; 2]> {
    let tracer = Tracer::new(scene);
    let count = scene.planes.len() * FREQUENCIES.len();
    let mut batches = vec![vec![0.0; count]; scene.run.batches as usize];
    for (batch, sums) in (0..).zip(&mut batches) {
        let emitted = tracer.emitted(batch) as f64;
        let mut record = |plane: usize, crossings: &[Crossing]| {
            let window = &scene.planes[plane].window;
            for Crossing { ray, weight } in crossings {
                let seen = window.value(ray) * weight / emitted;
                for (i, [x, y, u, v]) in FREQUENCIES.iter().enumerate() {
                    let phase = x * ray.x + y * ray.y + u * ray.u + v * ray.v;
                    sums[plane * FREQUENCIES.len() + i] += seen * libm::cos(TAU * phase);
                }
            }
        };
        tracer.emit(batch, &mut record, &|_| ());
    }
    let number = batches.len() as f64;
    let of = |i: usize| {
        let values = || batches.iter().map(|batch| batch[i]);
        let mean = values().sum::<f64>() / number;
        let squares: f64 = values().map(|value| (value - mean) * (value - mean)).sum();
        [mean, squares / (number * (number - 1.0))]
    };
    (0..count).map(of).collect()
}

#[test]
fn lattices_have_the_mean_of_random_numbers_and_less_noise() {
    let file = SceneFile::parse(SCENE).unwrap();
    let scene = resolve("test", file, ".".as_ref(), u64::MAX).unwrap();
    let [random, lattice] = [Sampling::Random, Sampling::Lattice].map(|sampling| {
        let mut scene = scene.clone();
        scene.run.sampling = sampling;
        coefficients(&scene)
    });
    for (i, (a, b)) in random.iter().zip(&lattice).enumerate() {
        let z = (a[0] - b[0]) / (a[1] + b[1]).sqrt();
        // Chance exceeds 4 standard errors at one of ten numbers in 0.06 % of all runs.
        assert!(z.abs() < 4.0, "coefficient {i}: {a:?} and {b:?}");
    }
    let totals = [random, lattice].map(|all| all.iter().map(|[_, noise]| noise).sum::<f64>());
    // Nets have half the noise of random numbers here.
    assert!(totals[1] < 0.25 * totals[0], "{totals:?}");
}
