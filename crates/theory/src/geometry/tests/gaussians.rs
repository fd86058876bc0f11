//! Tests of the spectra and covariances of mapped fields.

use super::covariance::{gaussian_lobe, gaussian_spectrum, gaussian_window, power_spectrum};
use super::*;
use crate::geometry::Edition;
use crate::geometry::matrix::dot;
use etendue_field::Complex;
use std::f64::consts::TAU;

const FIELD: Matrix<4> = [
    [0.04, 0.005, 0.01, 0.0],
    [0.005, 0.05, 0.0, -0.008],
    [0.01, 0.0, 0.02, 0.0],
    [0.0, -0.008, 0.0, 0.03],
];

/// A path from a light to a surface and onward, with an offset.
fn path() -> AffineMap<4> {
    AffineMap::<4>::travel(1.5)
        .then(&AffineMap::<4>::incidence(0.7))
        .then(&AffineMap::<4>::curvature(SHAPE, 0.7))
}

#[test]
fn spectrum_of_a_mapped_gaussian() {
    let map = path();
    let after = map.covariance(&FIELD);
    let before = |omega: [f64; 4]| Complex::from(gaussian_spectrum(&FIELD, omega));
    let largest = gaussian_spectrum(&after, [0.0; 4]);
    for i in 0..20 {
        let omega = std::array::from_fn(|k| 1.5 * scatter(i, k));
        // The expected field is the Gaussian displaced by the offset, with the covariance of the
        // mapped rays.
        let phase = -TAU * dot(&omega, &map.offset);
        let expected = Complex::from_polar(gaussian_spectrum(&after, omega), phase);
        let got = map.spectrum(omega, &before);
        assert!((got - expected).norm() < 1e-13 * largest); // rounding of exponents up to 10
    }
}

#[test]
fn spectrum_of_a_map_is_the_transform_of_the_mapped_field() {
    // An asymmetric field, (1 + x − θ/2) exp(−π(…)), is transformed numerically after the map.
    let map = AffineMap::<2>::incidence(0.5).then(&AffineMap::<2>::curvature(0.8));
    let field = |[x, t]: [f64; 2]| {
        let gauss = libm::exp(-std::f64::consts::PI * (4.0 * x * x + 2.0 * x * t + 9.0 * t * t));
        (1.0 + x - 0.5 * t) * gauss
    };
    let back = map.inverse().unwrap();
    let after = |z: [f64; 2]| field(back.apply(z));
    // The transform is a trapezoid rule on a lattice. Both fields are below 1e-20 at the edges of
    // the lattice. Their spectra are also below 1e-20 above half of the sampling frequency.
    let transform = |f: &dyn Fn([f64; 2]) -> f64, [ox, ot]: [f64; 2]| -> Complex {
        let nodes = (-120..=120).map(|i| 0.04 * f64::from(i));
        let rows = nodes.clone().map(|x| -> Complex {
            let row = nodes.clone();
            row.map(|t| Complex::from_polar(f([x, t + 0.5]), -TAU * (ox * x + ot * (t + 0.5))))
                .sum()
        });
        rows.sum::<Complex>() * (0.04 * 0.04)
    };
    let before = |omega| transform(&field, omega);
    // The map of the printed equations gives a spectrum that differs detectably.
    let printed = Edition::Equations.incidence(0.5);
    let printed = printed.then(&AffineMap::<2>::curvature(0.8).spectrum_map());
    for omega in [[0.0, 0.0], [1.0, -0.7], [-0.5, 1.0]] {
        let expected = transform(&after, omega);
        let off = |got: Complex| (got - expected).norm();
        assert!(off(map.spectrum(omega, &before)) < 1e-13); // rounding; the value at zero is 0.2
        assert!(off(printed.spectrum(omega, &before)) > 0.01);
    }
}

#[test]
fn covariance_of_sampled_rays() {
    let map = path();
    let rays: Vec<[f64; 4]> = bundle(200, 0.5).collect();
    let covariance = |rays: &[[f64; 4]]| -> Matrix<4> {
        let count = rays.len() as f64;
        let mean: [f64; 4] =
            std::array::from_fn(|i| rays.iter().map(|z| z[i]).sum::<f64>() / count);
        let entry = |i: usize, j: usize| {
            let products = rays.iter().map(|z| (z[i] - mean[i]) * (z[j] - mean[j]));
            products.sum::<f64>() / count
        };
        crate::geometry::matrix::from_fn(entry)
    };
    let after: Vec<_> = rays.iter().map(|&z| map.apply(z)).collect();
    let (got, expected) = (map.covariance(&covariance(&rays)), covariance(&after));
    let off = |a: &Matrix<4>, b: &Matrix<4>| apart(&AffineMap::linear(*a), &AffineMap::linear(*b));
    assert!(off(&got, &expected) < 1e-14); // rounding of sums of 200 numbers below one
    // The covariance of the power spectrum transforms by `spectral_covariance` of the map.
    let power = power_spectrum(&got).unwrap();
    let moved = power_spectrum(&covariance(&rays)).unwrap();
    let moved = map.spectral_covariance(&moved).unwrap();
    assert!(off(&power, &moved) < 1e-12); // rounding of inverses; entries up to 10
}

#[test]
fn windows_and_lobes() {
    let wide = gaussian_window(&FIELD, [f64::INFINITY; 4]).unwrap();
    assert!(apart(&AffineMap::linear(wide), &AffineMap::linear(FIELD)) < 1e-16); // rounding
    // The covariance of light from a point is singular before and after a window. The windowed
    // variance along x = D u is finite: 1/σ² = 1/σu² + D²/σx².
    let point = [[4.0, 2.0], [2.0, 1.0]];
    let seen = gaussian_window(&point, [0.5, 0.3]).unwrap();
    let along: f64 = 1.0 / (1.0 + 4.0 / 0.25 + 1.0 / 0.09);
    // Rounding.
    assert!((seen[1][1] - along).abs() < 1e-16 && (seen[0][0] - 4.0 * along).abs() < 1e-16);
    assert!(power_spectrum(&point).is_none());
    let blurred = gaussian_lobe(&FIELD, 0.1);
    assert!((blurred[2][2] - 0.03).abs() < 1e-16 && (blurred[3][3] - 0.04).abs() < 1e-16);
    assert!((blurred[0][0] - FIELD[0][0]).abs() < 1e-16); // all three: rounding
}
