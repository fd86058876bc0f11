//! Tests twelve photons in four replicates against values computed with mpmath at 25 digits.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use crate::common::{hann, plane};
use etendue_field::{
    Complex, Crossing, FrequencyAxis, Ledger, PlaneTally, Projection, ProjectionGrid, SliceGrid,
    Slices, TwoPlane,
};
use etendue_spectrum::{Batch, CrossPower, Measurement, PlaneBatch, estimate};
use etendue_transform::direct;
use serde::Deserialize;
use std::f64::consts::PI;

#[derive(Deserialize)]
struct Block {
    window: Widths,
    photons: Vec<Photon>,
    samples: Vec<Sample>,
}

#[derive(Deserialize)]
struct Widths {
    a: f64,
    b: f64,
}

#[derive(Deserialize)]
struct Photon {
    replicate: u32,
    flux: f64,
    x: f64,
    y: f64,
    u: f64,
    v: f64,
}

#[derive(Deserialize)]
struct Sample {
    frequency: [f64; 4],
    sum: [f64; 2],
    sum_w2: f64,
    power_shot_corrected: f64,
    replicate_sums: Vec<[f64; 2]>,
    mean_spectrum: [f64; 2],
    cross_spectrum_power: f64,
}

fn complex([re, im]: [f64; 2]) -> Complex {
    Complex::new(re, im)
}

fn block() -> Block {
    serde_json::from_str(include_str!("photon_estimator.json")).unwrap()
}

fn crossing(photon: &Photon) -> Crossing {
    let Photon {
        flux, x, y, u, v, ..
    } = *photon;
    let ray = TwoPlane { x, y, u, v };
    let weight = flux * ray.secant_squared().powi(2);
    Crossing { ray, weight }
}

/// Evaluates the Gaussian window of the reference, which is not truncated.
fn gaussian(Widths { a, b }: &Widths, z: &TwoPlane) -> f64 {
    let exponent = (z.x * z.x + z.y * z.y) / (a * a) + (z.u * z.u + z.v * z.v) / (b * b);
    (-PI * exponent).exp()
}

/// The largest value of the reference; the tolerance is 1e-9 of this value, and rounding errors
/// are 1e-16 of it.
const LARGEST: f64 = 0.202_085_963_050_424_1;
const TOLERANCE: f64 = 1e-9 * LARGEST;

/// A measurement with one batch for each replicate, at a single frequency.
fn measurement(values: &[Complex]) -> Measurement {
    let none = FrequencyAxis {
        half: 0,
        spacing: 1.0,
    };
    let grid = SliceGrid {
        azimuths: 1,
        rho: none,
        nu: none,
    };
    let mut measurement = Measurement::new(vec![plane("only", hann(), grid)]);
    for (index, value) in (0..).zip(values) {
        let mut slices = Slices::zeros(grid);
        slices.half[[0, 0, 0]] = *value;
        let cells = ProjectionGrid::new(&hann(), 1);
        let projection = Projection {
            grid: cells,
            values: ndarray::Array2::zeros((1, 1)),
        };
        let tally = PlaneTally::default();
        let planes = vec![PlaneBatch {
            tally,
            moments: etendue_spectrum::RayMoments::default(),
            slices,
            projection,
        }];
        let ledger = Ledger::default();
        measurement
            .insert(Batch {
                index,
                emitted: 3,
                ledger,
                planes,
            })
            .unwrap();
    }
    measurement
}

#[test]
fn sums_and_powers_of_the_reference() {
    let block = block();
    let window = |z: &TwoPlane| gaussian(&block.window, z);
    let all: Vec<_> = block.photons.iter().map(crossing).collect();
    for sample in &block.samples {
        let sum = direct::at(&all, window, sample.frequency);
        assert!((sum - complex(sample.sum)).norm() < TOLERANCE);

        let squares: f64 = all
            .iter()
            .map(|c| (c.weight * window(&c.ray)).powi(2))
            .sum();
        assert!((squares - sample.sum_w2).abs() < TOLERANCE);
        assert!((sum.norm_sqr() - squares - sample.power_shot_corrected).abs() < TOLERANCE);

        // The cross power and its mean require independent replicates.
        let replicate = |r| {
            let photons = block.photons.iter().filter(move |p| p.replicate == r);
            let crossings: Vec<_> = photons.map(crossing).collect();
            direct::at(&crossings, window, sample.frequency)
        };
        let replicates: Vec<_> = (0..4).map(replicate).collect();
        for (found, expected) in replicates.iter().zip(&sample.replicate_sums) {
            assert!((found - complex(*expected)).norm() < TOLERANCE);
        }
        let measurement = measurement(&replicates);
        let mean = estimate::slices(&measurement, 0).unwrap().mean.half[[0, 0, 0]];
        assert!((mean - complex(sample.mean_spectrum)).norm() < TOLERANCE);
        let power = CrossPower::new(&measurement, 0).unwrap().power()[[0, 0]];
        assert!((power - sample.cross_spectrum_power).abs() < TOLERANCE);
        // The test is sensitive, because the power of the mean spectrum differs from the cross
        // power.
        assert!((mean.norm_sqr() - sample.cross_spectrum_power).abs() > 1e4 * TOLERANCE);
    }
}

#[test]
fn the_radiance_weight_and_the_window_matter() {
    let block = block();
    let bare: Vec<_> = block
        .photons
        .iter()
        .map(|p| Crossing {
            weight: p.flux,
            ..crossing(p)
        })
        .collect();
    let sample = &block.samples[1];
    let sum = direct::at(&bare, |z| gaussian(&block.window, z), sample.frequency);
    assert!((sum - complex(sample.sum)).norm() > 1e-3);
}
