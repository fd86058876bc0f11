//! The exact conversion between slopes, which are two-plane coordinates, and angles, which are
//! plane-sphere coordinates, with its tests.
//!
//! The conversion does not change positions. In 2D the slope is v = tan θ. In 4D the direction is
//! D + u X + v Y. With longitude θ and latitude φ the direction is cos φ (cos θ D + sin θ X) + sin
//! φ Y, so u = tan θ and v = tan φ / cos θ (Durand et al. 2005, section 5.2, whose "co-latitude" φ
//! is a latitude). Radiance does not change under the conversion; a density must be multiplied by
//! the Jacobian. Angles are in radians, within ± π/2.

use super::*;

/// Converts (x, v) to (x, θ).
pub(super) fn to_angles_2d([x, v]: [f64; 2]) -> [f64; 2] {
    [x, libm::atan(v)]
}

/// Converts (x, θ) to (x, v).
pub(super) fn to_slopes_2d([x, theta]: [f64; 2]) -> [f64; 2] {
    [x, libm::tan(theta)]
}

/// Returns dv/dθ = 1/cos² θ.
pub(super) fn jacobian_2d(theta: f64) -> f64 {
    libm::cos(theta).powi(-2)
}

/// Converts (x, y, u, v) to (x, y, θ, φ).
pub(super) fn to_angles([x, y, u, v]: [f64; 4]) -> [f64; 4] {
    [x, y, libm::atan(u), libm::atan2(v, libm::hypot(1.0_f64, u))]
}

/// Converts (x, y, θ, φ) to (x, y, u, v).
pub(super) fn to_slopes([x, y, theta, phi]: [f64; 4]) -> [f64; 4] {
    [x, y, libm::tan(theta), libm::tan(phi) / libm::cos(theta)]
}

/// Returns du dv / dθ dφ = 1/(cos³ θ cos² φ), at (θ, φ).
pub(super) fn jacobian([theta, phi]: [f64; 2]) -> f64 {
    libm::cos(theta).powi(-3) * libm::cos(phi).powi(-2)
}

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
