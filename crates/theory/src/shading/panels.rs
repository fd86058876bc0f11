//! Gauss rules on panels, for functions of an angle that are smooth inside each panel.

use crate::quadrature::gauss_legendre;
use std::f64::consts::TAU;

/// Number of nodes of a panel. The error is below 10⁻¹⁵ if two conditions hold: the panel contains
/// at most two cycles, and all poles are at least a panel's length away.
const NODES: usize = 24;
const CYCLES: f64 = 2.0;

/// Returns 2 ∫ f(θ) cos(2πΩθ) dθ over the panels between `ends`. This is the transform of an even
/// function that is given for θ > 0.
#[must_use]
pub fn even_transform(ends: &[f64], omega: f64, f: impl Fn(f64) -> f64) -> f64 {
    let rule = gauss_legendre(NODES);
    let panel = |ends: &[f64]| {
        let parts = (omega.abs() * (ends[1] - ends[0]) / CYCLES).ceil().max(1.0);
        let half = 0.5 * (ends[1] - ends[0]) / parts;
        let mut sum = 0.0;
        let mut part = 0.0;
        while part < parts {
            let middle = ends[0] + half * (2.0 * part + 1.0);
            for (x, weight) in &rule {
                let at = middle + half * x;
                sum += weight * f(at) * libm::cos(TAU * omega * at);
            }
            part += 1.0;
        }
        sum * half
    };
    2.0 * ends.windows(2).map(panel).sum::<f64>()
}

/// The ends of panels from 0 to `end`. The first panel has the length `first`, and each
/// later panel is as long as all panels before it.
pub(super) fn doubling(first: f64, end: f64) -> Vec<f64> {
    let mut ends = vec![0.0];
    let mut at = first;
    while at < end {
        ends.push(at);
        at *= 2.0;
    }
    ends.push(end);
    ends
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lorentzian_of_any_width() {
        for width in [1e-3, 0.1, 2.0] {
            let end = 1e9 * width;
            let f = |t: f64| width / (width * width + t * t);
            let sum = even_transform(&doubling(width, end), 0.0, f);
            assert!((sum - 2.0 * (end / width).atan()).abs() < 1e-13); // rounding of 60 panels
        }
    }

    #[test]
    fn a_box_at_high_frequency() {
        let sum = even_transform(&[0.0, 0.5], 100.3, |_| 1.0);
        let angle = 0.5 * TAU * 100.3;
        assert!((sum - angle.sin() / angle).abs() < 1e-14); // rounding
    }
}
