//! Tests of the kernel from slopes to angles.

use super::plane_sphere_kernel::plane_sphere_kernel;
use crate::quadrature::integrate;
use etendue_field::Complex;
use std::f64::consts::{PI, TAU};

/// The accuracy of the kernel that its documentation states.
const STATED: f64 = 1e-13;

#[test]
fn values_of_tricomi_function() {
    // These are values of π e^(−a) U(−b/2, 0, 2a)/Γ(1 + b/2), computed by mpmath 1.3 with 60
    // digits.
    let values = [
        (0.001, 160.0, -0.004_354_544_446_450_9),
        (1e-6, 2.3, -0.090_144_709_358_218_17),
        (0.5, 0.0, 0.135_760_528_150_296_69),
        (0.2, 1e-9, 0.894_127_255_545_143_2),
        (3.0, 12.0, 0.011_033_262_795_408_139),
        (10.0, 9.7, 0.380_627_558_529_827_7),
        (40.0, 60.0, -0.215_529_040_069_167_3),
        (100.0, 160.0, 0.083_729_584_024_842_22),
        (150.0, 151.0, 0.320_404_612_789_728_1),
        (-0.3, -12.0, 0.153_114_982_134_468_1),
        (0.02, -1.7, -0.035_110_028_022_150_32),
    ];
    for (v, theta, expected) in values {
        let off = (plane_sphere_kernel(v, theta) - expected).abs();
        assert!(off < STATED, "({v}, {theta}): {off:e}");
    }
}

#[test]
fn symmetry_and_zero() {
    for (v, theta) in [(0.3, 0.8), (2.0, -1.1), (0.01, 7.0), (0.0, 1.3)] {
        let (one, other) = (
            plane_sphere_kernel(v, theta),
            plane_sphere_kernel(-v, -theta),
        );
        assert!((one - other).abs() < 1e-16); // the same arithmetic
    }
    for theta in [0.0, 0.2, -0.7, 11.3] {
        let b = TAU * theta;
        let expected = if theta == 0.0 {
            PI
        } else {
            2.0 * libm::sin(0.5 * PI * b) / b
        };
        // The kernel is tested at zero and near zero, where its kink behaves as a ln a.
        assert!((plane_sphere_kernel(0.0, theta) - expected).abs() < STATED);
        assert!((plane_sphere_kernel(1e-15, theta) - expected).abs() < 1e-11);
    }
    assert!(plane_sphere_kernel(1.0, f64::INFINITY).is_nan());
    assert!(plane_sphere_kernel(f64::NAN, 1.0).is_nan());
}

#[test]
fn laguerre_polynomials_at_even_orders() {
    // U is a polynomial where b/2 = 0, 1, 2, 3, and K vanishes where b/2 is a negative integer.
    for v in [0.05, 0.4, 1.7] {
        let a = TAU * v;
        let decay = PI * libm::exp(-a);
        let three = 2.0 * a * (3.0 - 6.0 * a + 2.0 * a * a) / 3.0;
        let expected = [0.0, 0.0, 1.0, 2.0 * a, 2.0 * a * (a - 1.0), three];
        for (i, expected) in (-2..).zip(expected) {
            let got = plane_sphere_kernel(v, f64::from(i) / PI);
            assert!((got - decay * expected).abs() < STATED, "{v}, {i}");
        }
    }
}

/// Evaluates the kernel's integral along a path that is displaced into the complex plane, where
/// the integrand oscillates slowly. On the vertical sections at both ends of the path, tan(±π/2 +
/// it) = i coth t.
fn by_definition(v: f64, theta: f64) -> f64 {
    let (a, b) = (TAU * v, TAU * theta);
    let height = 0.4;
    let upright = integrate(400, [0.0, height], |t| libm::exp(b * t - a / libm::tanh(t)));
    let level: Complex = integrate(400, [-0.5 * PI, 0.5 * PI], |t| {
        let t = Complex::new(t, height);
        (Complex::i() * (a * t.tan() - b * t)).exp()
    });
    level.re - 2.0 * libm::sin(0.5 * PI * b) * upright
}

#[test]
fn the_integral_it_stands_for() {
    for i in 0..60 {
        let (v, theta) = (
            0.05 + 1.5 * super::scatter(i, 0).abs(),
            2.0 * super::scatter(i, 1),
        );
        let off = (plane_sphere_kernel(v, theta) - by_definition(v, theta)).abs();
        // On the displaced path, terms up to e^(0.4 · 12.6) = 150 cancel, which amplifies rounding
        // errors.
        assert!(off < 1e-12, "({v}, {theta}): {off:e}");
    }
}

#[test]
fn spectrum_of_a_gaussian_in_slope_seen_in_angle() {
    // Compares the transform of exp(−π tan² θ / w²) with its spectrum in slope times the kernel.
    let w: f64 = 0.8;
    for theta in [0.0, 0.4, 1.3] {
        let direct = integrate(200, [-0.5 * PI, 0.5 * PI], |t| {
            let v = libm::tan(t) / w;
            libm::exp(-PI * v * v) * libm::cos(TAU * theta * t)
        });
        // Substituting Ωv = ± s³ smooths the kink of the kernel at zero; e^(−π w² Ω²) is 1e-20 at Ω
        // = 5.
        let side = |sign: f64| {
            integrate(200, [0.0, libm::cbrt(5.0_f64)], |s| {
                let v = s * s * s;
                let slope = w * libm::exp(-PI * w * w * v * v);
                3.0 * s * s * slope * plane_sphere_kernel(sign * v, theta)
            })
        };
        let through = side(1.0) + side(-1.0);
        // After the substitution, the kink becomes s⁵ ln s. The coefficients of this function fall
        // as n^−12. The tolerance is the error of a rule with 200 nodes for such a function.
        assert!(
            (through - direct).abs() < 1e-12,
            "{theta}: {}",
            through - direct
        );
        // If slopes are treated as angles, the result differs detectably.
        let slopes = w * libm::exp(-PI * w * w * theta * theta);
        assert!((slopes - direct).abs() > 1e-3);
    }
}
