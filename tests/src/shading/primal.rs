//! Plain quadrature of functions of position and angle, independent of the quadrature that theory
//! uses.

use etendue_field::Complex;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Limit of the parameter of the double exponential rule. Beyond this limit, nodes equal the ends
/// of the interval up to rounding.
const LAST: f64 = 3.1;

/// Nodes and weights of the double exponential rule between two ends (Takahasi and Mori
/// 1974). The rule is accurate for functions with kinks or roots at the ends.
pub(super) fn between([low, high]: [f64; 2], count: i32) -> Vec<(f64, f64)> {
    let step = LAST / f64::from(count);
    let half = 0.5 * (high - low);
    (-count..=count)
        .map(|i| {
            let t = f64::from(i) * step;
            let z = FRAC_PI_2 * t.sinh();
            let weight = FRAC_PI_2 * t.cosh() / z.cosh().powi(2);
            (0.5 * (low + high) + half * z.tanh(), half * weight * step)
        })
        .collect()
}

/// Nodes and weights of the trapezoid rule over the interval centre ± reach. The rule is
/// accurate for functions that vanish at the ends.
pub(super) fn about(middle: f64, reach: f64, count: i32) -> impl Iterator<Item = (f64, f64)> {
    let step = reach / f64::from(count);
    (-count..=count).map(move |i| (middle + f64::from(i) * step, step))
}

/// e^(−2πit).
pub(super) fn wave(cycles: f64) -> Complex {
    Complex::from_polar(1.0, -TAU * cycles)
}

/// ∫ f(t) e^(−2πiΩt) dt as a sum over nodes.
pub(super) fn transform(
    nodes: impl IntoIterator<Item = (f64, f64)>,
    omega: f64,
    f: impl Fn(f64) -> f64,
) -> Complex {
    let terms = nodes.into_iter();
    terms.map(|(t, w)| wave(omega * t) * (w * f(t))).sum()
}

/// ∫ f(t) dt as a sum over nodes.
pub(super) fn integral(nodes: impl IntoIterator<Item = (f64, f64)>, f: impl Fn(f64) -> f64) -> f64 {
    nodes.into_iter().map(|(t, w)| w * f(t)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_root_at_the_end() {
        let sum = integral(between([0.0, 4.0], 60), f64::sqrt);
        assert!((sum - 16.0 / 3.0).abs() < 1e-13); // rounding
    }

    #[test]
    fn a_gaussian() {
        let sum = transform(about(0.3, 8.5, 60), 0.2, |t| {
            (-0.5 * (t - 0.3).powi(2)).exp()
        });
        let size = TAU.sqrt() * (-0.5 * (TAU * 0.2_f64).powi(2)).exp();
        assert!((sum - wave(0.06) * size).norm() < 1e-13); // rounding
    }
}
