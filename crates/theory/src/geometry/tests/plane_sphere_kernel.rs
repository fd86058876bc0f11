//! The kernel that converts spectra from slopes to angles.

use etendue_field::sinc;
use std::f64::consts::{PI, TAU};

/// The step of the trapezoid rule in ln t. For frequencies from 10⁻¹² to 160, a rule with twice
/// this step gives the same values up to rounding error.
const STEP: f64 = 1.0 / 32.0;
/// Maximum frequency at which the kernel is evaluated; the recurrence takes a step for each third
/// of a cycle per radian.
const MAX_FREQUENCY: f64 = 1e5;

/// The kernel of the change from slopes to angles, K(Ωv, Ωθ) = ∫ e^(2πi(Ωv tan t − Ωθ t))
/// dt over |t| < π/2. K is real. The spectrum in angles is L_angle(Ωx, Ωθ) = ∫ L_slope(Ωx, Ωv)
/// K(Ωv, Ωθ) dΩv (Durand et al. 2005, section 4, who plot it in Fig. 8 but give no formula).
///
/// Frequencies are in cycles per unit slope and per radian. The absolute error is below 10⁻¹³ (K is
/// at most π) for frequencies up to 160; the result is NaN beyond 10⁵. The computing time is
/// proportional to Ωθ.
///
/// K is π times Bateman's function k_b(a) with a = 2πΩv and b = 2πΩθ (docs/theory.md (30)). It
/// satisfies K(−Ωv, −Ωθ) = K(Ωv, Ωθ) and K(0, Ωθ) = π sinc(b/2).
pub(crate) fn plane_sphere_kernel(omega_v: f64, omega_theta: f64) -> f64 {
    let sign = if omega_v < 0.0 { -1.0 } else { 1.0 };
    let (a, b) = (sign * TAU * omega_v, sign * TAU * omega_theta);
    let evaluated = a <= TAU * MAX_FREQUENCY && b.abs() <= TAU * MAX_FREQUENCY;
    if !evaluated {
        f64::NAN
    } else if a < f64::MIN_POSITIVE {
        PI * sinc(0.5 * b)
    } else if b < 1.0 {
        scaled(a, b) * libm::exp(-a)
    } else {
        climbed(a, b)
    }
}

/// Returns e^a K for b < 1. The path of integration goes from −π/2 up to −π/2 + i∞, and from π/2 +
/// i∞ down to π/2, where tan(±π/2 + it) = i coth t.
fn scaled(a: f64, b: f64) -> f64 {
    let twice_sine = 2.0 * libm::sin(0.5 * PI * b);
    let damping = |t: f64| -2.0 * a / libm::expm1(2.0 * t); // −a (coth t − 1)
    if b < -1.0 {
        -twice_sine * integral(|t| libm::exp(damping(t) + b * t))
    } else {
        // The integral of e^(bt) converges only for b < 0, so it is computed separately in closed
        // form.
        PI * sinc(0.5 * b) - twice_sine * integral(|t| libm::expm1(damping(t)) * libm::exp(b * t))
    }
}

/// Integrates f(t) over t > 0, for integrands that fall as e^(−t) or faster and are smooth
/// functions of ln t.
fn integral(f: impl Fn(f64) -> f64) -> f64 {
    // The integral is truncated to t from e^−40 to e^4.2 = 67; the omitted part is less than
    // 1e-17.
    let nodes = (-1280..=134).map(|i| libm::exp(f64::from(i) * STEP));
    nodes.map(|t| t * f(t)).sum::<f64>() * STEP
}

/// K for b ≥ 1 from the values of K at two smaller b. For m = b/2, this is the recurrence
/// of Tricomi's U (DLMF 13.3.7), which is (m + 1) K(m + 1) = 2(a − m) K(m) − (m − 1) K(m − 1). Both
/// solutions of this recurrence oscillate if b > a. If b < a, K is the solution that grows, so the
/// recurrence is stable.
fn climbed(a: f64, b: f64) -> f64 {
    const HUGE: f64 = 1e100;
    let steps = (0.5 * (b + 1.0)).floor();
    let lowest = b - 2.0 * steps;
    let (mut m, top) = (0.5 * lowest, 0.5 * b - 0.5);
    let (mut before, mut value) = (scaled(a, lowest - 2.0), scaled(a, lowest));
    let mut exponent = -a;
    while m < top {
        let next = (2.0 * (a - m) * value - (m - 1.0) * before) / (m + 1.0);
        (before, value) = (value, next);
        m += 1.0;
        if value.abs() > HUGE {
            (before, value) = (before / HUGE, value / HUGE);
            exponent += libm::log(HUGE);
        }
    }
    value * libm::exp(exponent)
}
