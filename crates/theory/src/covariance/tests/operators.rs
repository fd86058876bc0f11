//! Tests of covariance operators on Gaussian light fields.

use super::{apart, bent};
use crate::covariance::{SpectralCovariance, power};
use crate::geometry::tests::covariance::{gaussian_spectrum, gaussian_window, power_spectrum};
use crate::geometry::{AffineMap, Matrix, diagonal, sum};
use std::f64::consts::PI;

const LIGHT: [f64; 4] = [0.02, 0.03, 0.05, 0.04];
const WINDOW: [f64; 4] = [0.2, 0.3, 0.25, 0.15];

/// The spectral covariance of a Gaussian window with the standard deviations of these
/// tests.
fn window() -> Matrix<4> {
    diagonal(WINDOW.map(|s: f64| 1.0 / (8.0 * PI * PI * s * s)))
}

fn lobe() -> Matrix<4> {
    diagonal([0.0, 0.0, 0.01, 0.006])
}

/// The spectral covariance C of a Gaussian light field, computed by mapping, windowing and
/// blurring the field's covariance S.
fn followed() -> Matrix<4> {
    let travelled = AffineMap::<4>::travel(1.3).covariance(&diagonal(LIGHT));
    let blocked = gaussian_window(
        &travelled,
        [0.1, f64::INFINITY, f64::INFINITY, f64::INFINITY],
    );
    let reflected = sum(&bent().covariance(&blocked.unwrap()), &lobe());
    power_spectrum(&gaussian_window(&reflected, WINDOW).unwrap()).unwrap()
}

fn traced() -> SpectralCovariance {
    let mut blocker = [[0.0; 4]; 4];
    blocker[0][0] = 1.0 / (8.0 * PI * PI * 0.01);
    SpectralCovariance::new(LIGHT)
        .mapped(&AffineMap::travel(1.3))
        .unwrap()
        .multiplied(&blocker)
        .mapped(&bent())
        .unwrap()
        .convolved(&lobe())
        .multiplied(&window())
}

#[test]
fn a_gaussian_field_has_what_is_traced() {
    let off = apart(&traced().matrix().unwrap(), &followed());
    assert!(off < 1e-12, "{off}"); // rounding of inverses of condition 10³
}

/// Tests the definition, ∫ ∇l ∇lᵀ/(4π² ∫ l²), by finite differences of the field itself in (x, u).
/// To evaluate the field, the test follows a ray back through free space and windows, without
/// matrices.
#[test]
fn the_definition_gives_what_is_traced() {
    let [d, e] = [0.7, 0.4];
    let gauss = |t: f64, s: f64| libm::exp(-0.5 * t * t / s);
    let field = |[x, u]: [f64; 2]| {
        let at_blocker = x - e * u;
        gauss(at_blocker - d * u, LIGHT[0])
            * gauss(u, LIGHT[2])
            * gauss(at_blocker, 0.01)
            * gauss(x, WINDOW[0] * WINDOW[0])
            * gauss(u, WINDOW[2] * WINDOW[2])
    };
    let (step, half) = (0.01, 1e-4);
    let mut moments = [0.0; 4];
    for i in -150..=150 {
        for j in -150..=150 {
            let [x, u] = [i, j].map(|k| step * f64::from(k));
            let along = [
                (field([x + half, u]) - field([x - half, u])) / (2.0 * half),
                (field([x, u + half]) - field([x, u - half])) / (2.0 * half),
            ];
            moments[0] += along[0] * along[0];
            moments[1] += along[0] * along[1];
            moments[2] += along[1] * along[1];
            moments[3] += field([x, u]).powi(2);
        }
    }
    let [xx, xu, uu, norm] = moments;
    let [xx, xu, uu] = [xx, xu, uu].map(|m| m / (4.0 * PI * PI * norm));
    let mut blocker = [[0.0; 4]; 4];
    blocker[0][0] = 1.0 / (8.0 * PI * PI * 0.01);
    let c = SpectralCovariance::new(LIGHT)
        .mapped(&AffineMap::travel(d))
        .unwrap()
        .multiplied(&blocker)
        .mapped(&AffineMap::travel(e))
        .unwrap()
        .multiplied(&window())
        .matrix()
        .unwrap();
    // The relative error of the finite differences is half² divided by the width squared,
    // 1e-8/0.01; the error of the sum is much smaller.
    for (got, expected) in [(c[0][0], xx), (c[0][2], xu), (c[2][2], uu)] {
        assert!((got / expected - 1.0).abs() < 3e-6, "{got} {expected}");
    }
    // Travel over d moves spectral power at ρ to ν = −d ρ, so the covariance of ρ and ν is
    // negative.
    assert!(c[0][2] < 0.0);
}

#[test]
fn light_without_end_is_what_its_window_is() {
    let flat = SpectralCovariance::new([f64::INFINITY; 4]);
    assert_eq!(flat.matrix(), Some([[0.0; 4]; 4]));
    assert!(flat.field().is_none());
    let seen = flat.mapped(&bent()).unwrap().multiplied(&window());
    assert!(apart(&seen.matrix().unwrap(), &window()) < 1e-14); // rounding
}

/// Tests that the spectrum of light from a point is unbounded under any window, and bounded after
/// a convolution with a lobe.
#[test]
fn light_of_a_point_is_finite_behind_a_lobe() {
    let variance = [0.0, 0.0, 0.05, 0.04];
    let point = SpectralCovariance::new(variance).mapped(&bent()).unwrap();
    assert!(point.multiplied(&window()).matrix().is_none());
    let blurred = point.convolved(&lobe());
    let expected = sum(&bent().covariance(&diagonal(variance)), &lobe());
    let expected = power_spectrum(&expected).unwrap();
    assert!(apart(&blurred.matrix().unwrap(), &expected) < 1e-12); // rounding of inverses
}

#[test]
fn a_lobe_without_width_changes_nothing() {
    let still = traced().convolved(&[[0.0; 4]; 4]);
    assert_eq!(still, traced());
}

/// Tests that diffuse reflection is the limit of wide lobes: the variance of the irradiance does
/// not change, and light becomes uniform in slope.
#[test]
fn diffuse_reflection_is_the_limit_of_lobes() {
    let wide = diagonal([0.0, 0.0, 1e7, 2e7]);
    let limit = traced().convolved(&wide).matrix().unwrap();
    let diffuse = traced().diffused().matrix().unwrap();
    for (i, (got, near)) in diffuse
        .iter()
        .flatten()
        .zip(limit.iter().flatten())
        .enumerate()
    {
        // A lobe of variance 10⁷ differs from diffuse reflection by 1/(8π² 10⁷) in the entries for
        // angles. In the other entries, it differs by the square root of this number.
        assert!((got - near).abs() < 1e-4, "{i}: {got} {near}");
    }
    assert_eq!(diffuse[2..], [[0.0; 4]; 2]);
    // The integral ∫ l du dv keeps the block of S for positions.
    let field = traced().field().unwrap();
    let determinant = field[0][0] * field[1][1] - field[0][1] * field[1][0];
    let expected = field[1][1] / determinant / (8.0 * PI * PI);
    assert!((diffuse[0][0] / expected - 1.0).abs() < 1e-12); // rounding of inverses
    // Light that is already uniform stays uniform. Light from a point is uniform over the receiver.
    let flat = SpectralCovariance::new([f64::INFINITY; 4]);
    assert_eq!(flat.diffused().matrix(), Some([[0.0; 4]; 4]));
    let lamp = SpectralCovariance::new([0.0, 0.0, f64::INFINITY, f64::INFINITY]);
    let lit = lamp.mapped(&AffineMap::travel(2.0)).unwrap().diffused();
    assert_eq!(lit.matrix(), Some([[0.0; 4]; 4]));
}

#[test]
fn power_is_that_of_the_spectrum() {
    let field = traced().field().unwrap();
    let zero = gaussian_spectrum(&field, [0.0; 4]);
    for omega in [
        [0.3, 0.0, 0.0, 0.0],
        [0.5, -0.2, 0.4, 0.1],
        [0.0, 0.0, 0.7, -0.6],
    ] {
        let expected = (gaussian_spectrum(&field, omega) / zero).powi(2);
        assert!((power(&field, omega) - expected).abs() < 1e-14); // rounding
    }
}
