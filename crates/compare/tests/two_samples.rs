//! Tests the comparison of two measurements of one plane on synthetic batches, where the truth is
//! known.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::made_up::{noise, plane};
use etendue_compare::{Estimate, Sample, TwoSamples, noise_dof, pull};
use etendue_field::{Complex, Ledger, PlaneTally, Projection, ProjectionGrid, Slices};
use etendue_spectrum::{
    Batch, Measurement, PROJECTION_BINS, PlaneBatch, RayMoments, estimate::slices,
};
use ndarray::Array3;

const BATCHES: usize = 32;
const SEEDS: u64 = 200;

/// A smooth spectrum.
fn truth() -> Array3<Complex> {
    let grid = plane().grid;
    Array3::from_shape_fn(grid.half_shape(), |(_, m, n)| {
        let square = (m * m) as f64 + grid.nu.value(n).powi(2);
        Complex::new(libm::exp(-square / 20.0), 0.0)
    })
}

/// Slices of one batch: the truth plus noise. Each noise number spreads over three
/// neighbours along ν with the weights 1/2, 1, 1/2, as with a Hann window. The noise decreases with
/// ρ.
fn batch(seed: u64, index: usize, size: f64) -> Slices {
    let grid = plane().grid;
    let [azimuths, rho, nu] = grid.half_shape();
    let white = Array3::from_shape_fn((azimuths, rho, nu + 2), |(k, m, n)| {
        let cell = (k * rho + m) * (nu + 2) + n;
        noise(seed, (index as u64) << 32 | cell as u64)
    });
    let mut half = truth();
    for ((k, m, n), value) in half.indexed_iter_mut() {
        let near = white[[k, m, n]] * 0.5 + white[[k, m, n + 1]] + white[[k, m, n + 2]] * 0.5;
        *value += near * (size / (1.0 + m as f64));
    }
    Slices { grid, half }
}

/// The mean of this many batches and its noise.
fn sample(seed: u64, batches: usize, size: f64) -> Sample {
    let plane = plane();
    let mut measurement = Measurement::new(vec![plane.clone()]);
    let grid = ProjectionGrid::new(&plane.window, PROJECTION_BINS);
    for index in 0..batches {
        let values = ndarray::Array2::zeros((grid.bins, grid.bins));
        let of_plane = PlaneBatch {
            tally: PlaneTally {
                crossed: 100,
                inside: 100,
                outside: 0,
            },
            moments: RayMoments::default(),
            slices: batch(seed, index, size),
            projection: Projection { grid, values },
        };
        let batch = Batch {
            index: u32::try_from(index).unwrap(),
            emitted: 100,
            ledger: Ledger::default(),
            planes: vec![of_plane],
        };
        measurement.insert(batch).unwrap();
    }
    let estimate = slices(&measurement, 0).unwrap();
    Sample {
        mean: estimate.mean.half,
        sigma: estimate.variance.mapv(f64::sqrt),
        noise_dof: noise_dof(&measurement, 0).unwrap(),
        batches,
    }
}

const SIZE: f64 = 0.2;

/// Pairs of independent samples; the noise of the second may differ.
fn pairs(batches: usize, size: f64) -> Vec<(Sample, Sample)> {
    (0..SEEDS)
        .map(|seed| {
            let a = sample(2 * seed, BATCHES, SIZE);
            (a, sample(2 * seed + 1, batches, size))
        })
        .collect()
}

fn p_values(pairs: &[(Sample, Sample)]) -> Vec<f64> {
    let grid = plane().grid;
    let p = pairs.iter().map(|(a, b)| TwoSamples::new(&grid, a, b));
    p.map(|test| test.p_value.unwrap()).collect()
}

/// The largest distance of the distribution of `values` from uniform, in units of 1/√n:
/// 1.63 is exceeded once in a hundred times (Smirnov 1948).
fn distance(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len() as f64;
    let each = sorted.iter().enumerate();
    let apart = each.map(|(i, p)| (p - i as f64 / n).abs().max(((i + 1) as f64 / n - p).abs()));
    apart.fold(0.0, f64::max) * n.sqrt()
}

/// The 1 % level of the Kolmogorov–Smirnov test.
const SMIRNOV: f64 = 1.63;

#[test]
fn p_is_uniform_for_two_measurements_of_one_plane() {
    let alike = pairs(BATCHES, SIZE);
    let found = distance(&p_values(&alike));
    assert!(found < SMIRNOV, "{found}");
    // The second sample has twice the batches and a third of the noise, so nearly all noise comes
    // from the first.
    let unlike = distance(&p_values(&pairs(2 * BATCHES, SIZE / 3.0)));
    assert!(unlike < SMIRNOV, "{unlike}");

    // The injected faults are a σ that is wrong by 10 %, and a test that treats frequencies as
    // independent.
    for scale in [0.9, 1.1] {
        let mut planted = alike.clone();
        for (a, b) in &mut planted {
            a.sigma *= scale;
            b.sigma *= scale;
        }
        let found = distance(&p_values(&planted));
        assert!(found > SMIRNOV, "σ × {scale}: {found}");
    }
    let mut planted = alike;
    for (a, b) in &mut planted {
        a.noise_dof = a.noise_dof.map(|dof| 4.0 * dof);
        b.noise_dof = b.noise_dof.map(|dof| 4.0 * dof);
    }
    let found = distance(&p_values(&planted));
    assert!(found > SMIRNOV, "independent frequencies: {found}");
}

#[test]
fn noise_amounts_to_as_many_numbers_as_its_correlation_leaves() {
    // Direct neighbours along ν have the correlation 2/3, and second neighbours have the
    // correlation 1/6. Therefore a line of n cells has tr C² = n + 2 (n − 1) 4/9 + 2 (n − 2)/36,
    // and half of that for complex numbers.
    let squares = |n: f64| n + (n - 1.0) * 8.0 / 9.0 + (n - 2.0) / 18.0;
    let found: Vec<f64> = (0..50)
        .map(|seed| sample(seed, BATCHES, SIZE).noise_dof.unwrap())
        .collect();
    let mean = found.iter().sum::<f64>() / 50.0;
    // Each of two azimuths has six lines with ρ > 0, and half of the line with ρ = 0.
    let frequencies = 2.0 * (6.0 * 13.0 + 7.0);
    let expected = 2.0 * frequencies * frequencies / (2.0 * (6.0 * squares(13.0) + squares(7.0)));
    // Each frequency is divided by its own σ. This σ is estimated from 32 batches, which increases
    // the result by two parts in 31.
    assert!((mean / expected - 1.0).abs() < 0.065, "{mean} {expected}");
}

#[test]
fn a_difference_of_twice_the_noise_is_found() {
    let grid = plane().grid;
    for seed in 0..20 {
        let [a, mut b] = [2 * seed, 2 * seed + 1].map(|seed| sample(seed, BATCHES, SIZE));
        let sound = TwoSamples::new(&grid, &a, &b);
        assert!(sound.p_value.unwrap() > 1e-4, "{sound:?}"); // of twenty, one in 500 runs
        // The samples differ in norm: the second truth is 1 + ε times the first, where ε ‖truth‖
        // is twice the noise of the difference.
        let noise: f64 = a.sigma.iter().chain(&b.sigma).map(|s| s * s).sum();
        let norm: f64 = truth().iter().map(|s| s.norm_sqr()).sum();
        let epsilon = 2.0 * (noise / norm).sqrt();
        b.mean = b.mean + truth() * Complex::from(epsilon);
        let planted = TwoSamples::new(&grid, &a, &b);
        assert!(planted.p_value.unwrap() < 1e-6, "{planted:?}");
        assert!(planted.difference > 1.5 * planted.noise, "{planted:?}");
    }
}

#[test]
fn shared_photons_are_told_from_agreement() {
    let grid = plane().grid;
    let a = sample(1, BATCHES, SIZE);
    let same = TwoSamples::new(&grid, &a, &a);
    assert!(same.p_shared.unwrap() < 1e-12 && same.difference <= 0.0);
    // With half of the batches in common, the difference has half the variance.
    let mut half = sample(2, BATCHES, SIZE);
    half.mean = (&half.mean + &a.mean) * Complex::from(0.5);
    let half = TwoSamples::new(&grid, &a, &half);
    assert!(half.p_shared.unwrap() < 1e-6, "{half:?}");
    let other = TwoSamples::new(&grid, &a, &sample(3, BATCHES, SIZE));
    assert!(other.p_shared.unwrap() > 1e-3, "{other:?}");
}

#[test]
fn dark_planes_are_alike_and_unlike_lit_ones() {
    let grid = plane().grid;
    let lit = sample(1, BATCHES, SIZE);
    let dark = Sample {
        mean: Array3::zeros(grid.half_shape()),
        sigma: Array3::zeros(grid.half_shape()),
        noise_dof: None,
        batches: BATCHES,
    };
    let both = TwoSamples::new(&grid, &dark, &dark);
    assert!(both.p_value.is_none() && both.difference <= 0.0);
    assert!(TwoSamples::new(&grid, &lit, &dark).p_value.unwrap() < 1e-12);
    let bright = Sample {
        mean: truth(),
        ..dark.clone()
    };
    let without_noise = TwoSamples::new(&grid, &bright, &dark);
    assert!(without_noise.p_value.unwrap() <= 0.0, "{without_noise:?}");
}

#[test]
fn pulls_are_in_units_of_both_errors() {
    let estimate = |value: f64, error: f64| Estimate {
        value,
        error,
        batches: 64,
    };
    let (found, p) = pull(estimate(1.0, 0.3), estimate(3.0, 0.4)).unwrap();
    assert!((found + 4.0).abs() < 1e-12); // rounding
    // The probability of Student's t with about 117 degrees of freedom at 4 is 1.1e-4.
    assert!((p - 1.1e-4).abs() < 0.1e-4, "{p}");
    assert!(pull(estimate(1.0, 0.0), estimate(1.0, 0.0)).is_none());
}
