//! Discs as weighted sums of rectangles. In this form, products of discs and other shapes are sums
//! of products of rectangles.

use crate::parallel::weighted_rectangle::WeightedRectangle;
use etendue_field::{Disc, Shape};
use std::f64::consts::FRAC_PI_2;

/// The method for splitting a disc into rectangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Discs {
    /// A sum of n × n weighted rectangles about the disc's centre, which is used for spectra.
    Rule(usize),
    /// A sum of n strips along y, which is used for the light field itself. Each strip has the same
    /// area as the part of the disc between the strip's two values of x.
    Strips(usize),
}

impl Discs {
    pub(crate) fn count(self) -> usize {
        match self {
            Self::Rule(n) | Self::Strips(n) => n,
        }
    }

    pub(crate) fn patches(self, disc: &Disc) -> Vec<WeightedRectangle> {
        match self {
            Self::Rule(n) => rule(disc, n),
            Self::Strips(n) => strips(disc, n),
        }
    }
}

/// The rectangles into which a shape is split.
pub(crate) fn patches_of(shape: &Shape, discs: Discs) -> Vec<WeightedRectangle> {
    match shape {
        Shape::Rectangle(rectangle) => vec![WeightedRectangle::of_rectangle(rectangle)],
        Shape::Disc(disc) => discs.patches(disc),
    }
}

/// The rectangles of the sum Σ w_jk 1[|x| < R cos t_j] 1[|y| < R sin t_k], where t_j = π
/// (2j + 1)/4n (docs/theory.md (5b)).
///
/// In an integral over the product of a smooth function and the disc, this sum replaces the disc.
/// The integral of the function over the disc is ∫ A(R cos t) dB(R sin t), where A and B are the
/// integrals along the two sides of a rectangle. The functions A and B are odd, so they are
/// expanded in the cosines and sines of odd multiples of t. The sum over multiples m < 2n has a
/// closed form, π/n² Σ m cos(m t_j) sin(m t_k) = π/2n (c(k + j + 1) + c(k − j)), with c(i) =
/// −(−1)^i / sin(π i/2n) and c(0) = 0.
fn rule(disc: &Disc, n: usize) -> Vec<WeightedRectangle> {
    let angle = FRAC_PI_2 / n as f64;
    let node = |j: usize| angle * (j as f64 + 0.5);
    let cosecant = |i: usize| match i {
        0 => 0.0,
        _ if i.is_multiple_of(2) => -1.0 / libm::sin(angle * i as f64),
        _ => 1.0 / libm::sin(angle * i as f64),
    };
    let pairs = (0..n).flat_map(|j| (0..n).map(move |k| (j, k)));
    pairs
        .map(|(j, k)| {
            let half = [libm::cos(node(j)), libm::sin(node(k))].map(|t| disc.radius * t);
            let difference = if k < j { -1.0 } else { 1.0 } * cosecant(k.abs_diff(j));
            WeightedRectangle {
                extent: [0, 1].map(|i| [disc.center[i] - half[i], disc.center[i] + half[i]]),
                weight: angle * (cosecant(k + j + 1) + difference),
            }
        })
        .collect()
}

/// Returns n strips that are bounded by x = R sin t for n + 1 evenly spaced values of t. The error
/// of the strips is of second order in 1/n.
fn strips(disc: &Disc, n: usize) -> Vec<WeightedRectangle> {
    let angle = |i: usize| FRAC_PI_2 * (2.0 * i as f64 / n as f64 - 1.0);
    // The area of the part of the unit disc with x < sin t, up to a constant.
    let area = |t: f64| t + 0.5 * libm::sin(2.0 * t);
    (0..n)
        .map(|i| {
            let [from, to] = [angle(i), angle(i + 1)];
            let ends = [from, to].map(libm::sin);
            let half = 0.5 * (area(to) - area(from)) / (ends[1] - ends[0]);
            let around = |axis: usize, t: f64| disc.center[axis] + disc.radius * t;
            WeightedRectangle {
                extent: [
                    ends.map(|e| around(0, e)),
                    [-half, half].map(|h| around(1, h)),
                ],
                weight: 1.0,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::integrate;
    use etendue_field::sinc;
    use std::f64::consts::{PI, TAU};

    const DISC: Disc = Disc {
        center: [0.0, 0.0],
        radius: 0.3,
    };

    /// R J₁(2πRΩ)/Ω = 2 R² ∫ cos(2πRΩ sin t) cos²t dt over (−π/2, π/2).
    fn disc_transform(omega: f64) -> f64 {
        let angle = TAU * DISC.radius * omega;
        let f = |t: f64| libm::cos(angle * libm::sin(t)) * libm::cos(t).powi(2);
        2.0 * DISC.radius.powi(2) * integrate(64, [-FRAC_PI_2, FRAC_PI_2], f)
    }

    fn transform(patches: &[WeightedRectangle], omega: f64, azimuth: f64) -> f64 {
        let k = [libm::cos(azimuth), libm::sin(azimuth)].map(|c| c * omega);
        let side = |p: &WeightedRectangle, i: usize| p.extent[i][1] - p.extent[i][0];
        // The disc is symmetric, so only the even part of each rectangle's transform remains in
        // the sum.
        let middle = |p: &WeightedRectangle, i: usize| 0.5 * (p.extent[i][1] + p.extent[i][0]);
        let value = |p: &WeightedRectangle| {
            let phase = TAU * (k[0] * middle(p, 0) + k[1] * middle(p, 1));
            let factors = [0, 1].map(|i| side(p, i) * sinc(side(p, i) * k[i]));
            p.weight * factors[0] * factors[1] * libm::cos(phase)
        };
        patches.iter().map(value).sum()
    }

    fn worst(discs: Discs) -> f64 {
        let patches = discs.patches(&DISC);
        let area = PI * DISC.radius.powi(2);
        let mut worst = 0.0;
        for i in 0..=16 {
            for azimuth in [0.0, 0.3, 0.8, 1.2, FRAC_PI_2] {
                let omega = f64::from(i);
                let error = transform(&patches, omega, azimuth) - disc_transform(omega);
                worst = f64::max(worst, error.abs() / area);
            }
        }
        worst
    }

    #[test]
    fn the_rule_has_the_transform_of_a_disc() {
        // At the highest frequency π R Ω is 15.1, so the error falls with every node beyond 15
        // nodes.
        let errors = [16, 20, 24].map(|n| worst(Discs::Rule(n)));
        assert!(errors[0] < 1e-8, "{errors:?}");
        assert!(errors[1] < 1e-12, "{errors:?}");
        assert!(errors[2] < 1e-14, "{errors:?}"); // rounding
    }

    #[test]
    fn weights_are_the_sum_in_closed_form() {
        for n in [1, 2, 5, 12] {
            let patches = rule(&DISC, n);
            for (i, patch) in patches.iter().enumerate() {
                let [t, s] = [i / n, i % n].map(|j| PI * (2 * j + 1) as f64 / (4 * n) as f64);
                let odd = (0..n).map(|i| (2 * i + 1) as f64);
                let sum: f64 = odd.map(|m| m * libm::cos(m * t) * libm::sin(m * s)).sum();
                let expected = PI * sum / (n * n) as f64;
                assert!((patch.weight - expected).abs() < 1e-13); // rounding of weights up to 3
            }
        }
    }

    #[test]
    fn strips_are_of_second_order() {
        let [coarse, fine] = [64, 128].map(|n| worst(Discs::Strips(n)));
        // Twice as many strips reduce the error by a factor of 4, because the error term of the
        // next order is small.
        assert!((coarse / fine - 4.0).abs() < 0.2, "{}", coarse / fine);
        // Relative to the transform at the highest frequencies, the error is (π Ω R)² / 128² =
        // 0.014.
        assert!(fine < 1e-4, "{fine}");
    }
}
