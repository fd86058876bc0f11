//! Tests of the conversion between slopes and angles.

use super::*;
use crate::geometry::plane_sphere::{
    jacobian, jacobian_2d, to_angles, to_angles_2d, to_slopes, to_slopes_2d,
};

#[test]
fn there_and_back() {
    for z in bundle::<4>(20, 1.4) {
        let back = to_angles(to_slopes(z));
        let off = (0..4).map(|i| (back[i] - z[i]).abs());
        assert!(off.fold(0.0, f64::max) < 1e-14); // rounding, tangents up to 30
        let [x, v] = to_slopes_2d(to_angles_2d([z[0], z[1]]));
        assert!((x - z[0]).abs() + (v - z[1]).abs() < 1e-14); // rounding
    }
}

#[test]
fn the_direction_is_the_same() {
    for z in bundle::<4>(20, 1.4) {
        let [_, _, u, v] = to_slopes(z);
        let ((st, ct), (sp, cp)) = (libm::sincos(z[2]), libm::sincos(z[3]));
        let length = (1.0 + u * u + v * v).sqrt();
        let off = [
            u / length - cp * st,
            v / length - sp,
            1.0 / length - cp * ct,
        ];
        assert!(off.map(f64::abs).into_iter().fold(0.0, f64::max) < 1e-15); // rounding
    }
}

#[test]
fn jacobians_are_derivatives() {
    let h = 1e-5;
    for [theta, phi] in bundle::<2>(20, 1.1) {
        let slopes = |t, p| {
            let [_, _, u, v] = to_slopes([0.0, 0.0, t, p]);
            [u, v]
        };
        let difference = |a: [f64; 2], b: [f64; 2]| [0, 1].map(|i| (a[i] - b[i]) / (2.0 * h));
        let [ut, vt] = difference(slopes(theta + h, phi), slopes(theta - h, phi));
        let [up, vp] = difference(slopes(theta, phi + h), slopes(theta, phi - h));
        let (got, expected) = (ut * vp - up * vt, jacobian([theta, phi]));
        // The error is h² = 1e-10 times third derivatives, which are about 30 times the first
        // derivatives at 1.1 rad.
        assert!((got - expected).abs() < 1e-8 * expected);
        assert!((ut - jacobian_2d(theta)).abs() < 1e-8 * ut); // the same
        // The cosine times dω is du dv / (1 + u² + v²)² = cos θ cos² φ dθ dφ.
        let [u, v] = slopes(theta, phi);
        let solid = expected / (1.0 + u * u + v * v).powi(2);
        assert!((solid - theta.cos() * phi.cos().powi(2)).abs() < 1e-14); // rounding
    }
}
