//! The integrand of irradiance, (1 + u² + v²)^(−p) times the gratings. It is a function of the
//! slopes of light that arrives at a point.

use crate::barrier::Bounds;
use crate::quadrature::gauss_legendre;
use etendue_field::{Grating, whole};
use std::f64::consts::TAU;

/// The value −ln ε for the relative error ε = 10⁻¹² of a Gauss rule.
const NATS: f64 = 28.0;
/// Maximum number of nodes of a Gauss rule; intervals that need more nodes are divided into
/// panels.
const MAX_NODES: usize = 48;
/// Number of additional nodes on an arc, beyond the nodes that the arc's length requires. The
/// additional nodes are needed because the direction of the arc changes.
const ARC: usize = 10;
/// Number of panel lengths for which numbers of nodes are precomputed. Each length is half of the
/// previous length.
const LEVELS: usize = 24;
/// Estimated number of computing steps to evaluate a closed form.
const CLOSED: f64 = 100.0;
/// Rectangles that need at most this number of nodes are integrated numerically, because the terms
/// of the closed form nearly cancel for small rectangles.
const FEW_NODES: f64 = 16.0;

/// The lobe (1 + u² + v²)^(−p), where u and v are slopes.
#[derive(Clone, Copy, Debug)]
enum SlopePower {
    /// The constant lobe, p = 0.
    Flat,
    /// The lobe with p = 2, the factor G of docs/theory.md (7), which is the cosine of a Lambertian
    /// receiver times dω/(du dv).
    Cosine,
    /// The lobe with p = n/2 for an integer n.
    Half(i32),
    /// The lobe with an arbitrary real p.
    Power(f64),
}

impl SlopePower {
    #[expect(clippy::cast_possible_truncation, reason = "a small whole number")]
    fn new(power: f64) -> Self {
        if power.abs() < f64::EPSILON {
            Self::Flat
        } else if (power - 2.0).abs() < f64::EPSILON {
            Self::Cosine
        } else if (2.0 * power).fract().abs() < f64::EPSILON && power.abs() < 1e3 {
            Self::Half((2.0 * power) as i32)
        } else {
            Self::Power(power)
        }
    }

    /// The lobe's value at slopes with 1 + u² + v² = `secant_squared`.
    fn value(&self, secant_squared: f64) -> f64 {
        match *self {
            Self::Flat => 1.0,
            Self::Cosine => 1.0 / (secant_squared * secant_squared),
            Self::Half(n) => secant_squared.sqrt().recip().powi(n),
            Self::Power(power) => libm::pow(secant_squared, -power),
        }
    }
}

/// The numbers of nodes that intervals of slopes require. The number depends on the length of the
/// interval.
#[derive(Debug)]
struct NodeCounts {
    /// Length of the longest panel; a panel of level k is 2^k times shorter.
    longest: f64,
    levels: [usize; LEVELS],
}

impl NodeCounts {
    fn new(power: f64, frequency: f64) -> Self {
        let halves = |level: usize| 4.0 * libm::pow(0.5_f64, level as f64);
        let mut lengths = (0..).map(halves);
        let fits = |length: &f64| nodes(power, frequency, *length) <= MAX_NODES;
        let longest = lengths.find(fits).unwrap_or(f64::MIN_POSITIVE);
        let count = |level: usize| nodes(power, frequency, 0.25 * longest * halves(level));
        Self {
            longest,
            levels: std::array::from_fn(count),
        }
    }

    /// The number of panels for an interval of the given length, and the number of nodes
    /// in each panel.
    fn of(&self, length: f64) -> [usize; 2] {
        let ratio = self.longest / length.abs();
        if ratio < 1.0 {
            return [whole((1.0 / ratio).ceil()), self.levels[0]];
        }
        let level = whole(libm::log2(ratio).min((LEVELS - 1) as f64));
        [1, self.levels[level]]
    }
}

/// The number of nodes that integrate (1 + u² + v²)^(−p) e^(2πifu) over an interval of u to
/// the error e^(−[`NATS`]).
///
/// The error of the rule with n nodes is ρ^(−2n) times the largest value of the integrand on an
/// ellipse around the interval. The ellipse extends by b in the imaginary direction, and ln ρ =
/// arsinh(2b/length) (Trefethen 2013, *Approximation Theory and Approximation Practice*, Theorem
/// 19.3). The ellipse contains no pole if b < 1. The number is computed for several values of b,
/// and the smallest number is used.
fn nodes(power: f64, frequency: f64, length: f64) -> usize {
    let power = power.abs();
    let counts = (0..12).map(|k| {
        let b = 0.8 * 0.6_f64.powi(k);
        let beyond = libm::hypot(0.5 * length, b) - 0.5 * length;
        let growth = power * (beyond - libm::log(1.0 - b * b)) + TAU * frequency.abs() * b;
        (NATS + growth) / (2.0 * libm::asinh(2.0 * b / length))
    });
    whole(counts.fold(f64::INFINITY, f64::min).ceil())
}

/// The lobe, and Gauss rules for its integrals. The rules integrate the product of the lobe and the
/// gratings in front of the receiver.
#[derive(Debug)]
pub(crate) struct Integrator {
    lobe: SlopePower,
    /// Numbers of nodes for intervals of u and of v.
    counts: [NodeCounts; 2],
    /// Gauss rules on (−1, 1), by their number of nodes.
    rules: Vec<Vec<(f64, f64)>>,
}

impl Integrator {
    /// Builds rules for (1 + u² + v²)^(−`power`) times gratings. The frequencies of these
    /// gratings, in cycles per slope, add up to `frequencies` along u and along v.
    pub(crate) fn new(power: f64, frequencies: [f64; 2]) -> Self {
        Self {
            lobe: SlopePower::new(power),
            counts: frequencies.map(|f| NodeCounts::new(power, f)),
            rules: (0..=MAX_NODES + ARC).map(gauss_legendre).collect(),
        }
    }
}

/// The lobe times the gratings, as a function of slopes at one point of the receiver.
#[derive(Debug)]
pub(crate) struct ReceiverDensity<'a> {
    pub(crate) integrator: &'a Integrator,
    /// Gratings as functions of the slope. Their frequencies are in cycles per unit slope, and
    /// their phases are for this point of the receiver.
    pub(crate) gratings: Vec<Grating>,
}

impl ReceiverDensity<'_> {
    /// The value of the integrand at the slopes (u, v).
    #[cfg(test)]
    pub(crate) fn value(&self, u: f64, v: f64) -> f64 {
        let gratings = self.gratings.iter().map(|g| g.transmittance(u, v));
        self.integrator.lobe.value(1.0 + u * u + v * v) * gratings.product::<f64>()
    }

    /// The integral over a rectangle of slopes; if the bounds of an interval are in
    /// descending order, the integral changes sign.
    pub(crate) fn rectangle(&self, sides: Bounds) -> f64 {
        let [u, v] = sides;
        if self.gratings.is_empty() {
            let [along_u, along_v] = self.along(sides);
            match self.integrator.lobe {
                SlopePower::Flat => return (u[1] - u[0]) * (v[1] - v[0]),
                SlopePower::Cosine if along_u * along_v > FEW_NODES => return cosine(sides),
                _ => {}
            }
        }
        let across: Vec<_> = self.nodes(1, v).collect();
        let columns = self.nodes(0, u).map(|(u, weight)| {
            let lobe = |v: f64| self.integrator.lobe.value(1.0 + u * u + v * v);
            weight * across.iter().map(|&(v, w)| w * lobe(v)).sum::<f64>()
        });
        columns.sum()
    }

    /// The integral over u from `from` to `to` at a fixed v.
    pub(crate) fn along_u(&self, [from, to]: [f64; 2], v: f64) -> f64 {
        if self.gratings.is_empty() {
            match self.integrator.lobe {
                SlopePower::Flat => return to - from,
                SlopePower::Cosine => return cosine_along_u(to, v) - cosine_along_u(from, v),
                SlopePower::Half(_) | SlopePower::Power(_) => {}
            }
        }
        let lobe = |u: f64| self.integrator.lobe.value(1.0 + u * u + v * v);
        let along: f64 = self.nodes(0, [from, to]).map(|(u, w)| w * lobe(u)).sum();
        let across = self.gratings.iter().filter(|g| g.axis == 1);
        along * across.map(|g| g.transmittance(0.0, v)).product::<f64>()
    }

    /// The number of parts into which an arc of the given length and of at most a quarter
    /// turn is divided, and the Gauss rule on (−1, 1) for each part.
    pub(crate) fn arc(&self, length: f64) -> (usize, &[(f64, f64)]) {
        let [u, v] = self.integrator.counts.each_ref().map(|c| c.of(length));
        let [panels, nodes] = [0, 1].map(|k| u[k].max(v[k]));
        (panels, &self.integrator.rules[nodes + ARC])
    }

    /// Estimates the number of computing steps of [`Self::rectangle`].
    pub(crate) fn steps(&self, sides: Bounds) -> f64 {
        let [u, v] = self.along(sides);
        match self.integrator.lobe {
            SlopePower::Flat if self.gratings.is_empty() => CLOSED,
            SlopePower::Cosine if self.gratings.is_empty() && u * v > FEW_NODES => CLOSED,
            _ => self.step() * (u * v + 10.0 * (u + v)),
        }
    }

    /// Estimates the number of computing steps of [`Self::along_u`] over an interval of the given
    /// length.
    pub(crate) fn steps_along_u(&self, length: f64) -> f64 {
        match self.integrator.lobe {
            SlopePower::Flat | SlopePower::Cosine if self.gratings.is_empty() => CLOSED,
            _ => self.step() * self.along([[0.0, length], [0.0; 2]])[0],
        }
    }

    /// Estimates the number of computing steps to evaluate the lobe at a node.
    fn step(&self) -> f64 {
        match self.integrator.lobe {
            SlopePower::Flat | SlopePower::Cosine => 3.0,
            SlopePower::Half(_) => 10.0,
            SlopePower::Power(_) => 40.0,
        }
    }

    /// The number of nodes along each side of a rectangle of slopes.
    fn along(&self, sides: Bounds) -> [f64; 2] {
        [0, 1].map(|axis| {
            let [low, high] = sides[axis];
            let [panels, nodes] = self.integrator.counts[axis].of(high - low);
            panels as f64 * nodes as f64
        })
    }

    /// The nodes of an interval of slopes along an axis; the nodes' weights include the
    /// gratings along this axis.
    fn nodes(&self, axis: usize, [low, high]: [f64; 2]) -> impl Iterator<Item = (f64, f64)> {
        let [panels, nodes] = self.integrator.counts[axis].of(high - low);
        let rule = &self.integrator.rules[nodes];
        let half = 0.5 * (high - low) / panels as f64;
        (0..panels).flat_map(move |panel| {
            let middle = low + (2 * panel + 1) as f64 * half;
            rule.iter().map(move |&(node, weight)| {
                let slope = middle + half * node;
                let gratings = self.gratings.iter().filter(|g| g.axis == axis);
                let passed: f64 = gratings.map(|g| g.transmittance(slope, slope)).product();
                (slope, weight * half * passed)
            })
        })
    }
}

/// ∫∫ (1 + u² + v²)⁻² du dv over a rectangle (docs/theory.md (15)).
fn cosine([[u0, u1], [v0, v1]]: Bounds) -> f64 {
    let corner = |u: f64, v: f64| {
        let side = |u: f64, v: f64| {
            let c = libm::hypot(u, 1.0);
            u / c * libm::atan(v / c)
        };
        0.5 * (side(u, v) + side(v, u))
    };
    (corner(u1, v1) - corner(u0, v1)) - (corner(u1, v0) - corner(u0, v0))
}

/// ∫ (1 + u² + v²)⁻² du from 0 to u.
fn cosine_along_u(u: f64, v: f64) -> f64 {
    let c2 = 1.0 + v * v;
    let c = c2.sqrt();
    (u / (c2 + u * u) + libm::atan(u / c) / c) / (2.0 * c2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::integrate;

    fn density(integrator: &Integrator) -> ReceiverDensity<'_> {
        ReceiverDensity {
            integrator,
            gratings: vec![],
        }
    }

    /// Computes the integral over a rectangle by many panels of many nodes each, as a reference.
    fn brute(density: &ReceiverDensity<'_>, [u, v]: Bounds) -> f64 {
        let cut = |[low, high]: [f64; 2], i: u32| {
            let step = (high - low) / 20.0;
            [low + step * f64::from(i), low + step * f64::from(i + 1)]
        };
        let panels = (0..20).flat_map(|i| (0..20).map(move |j| (i, j)));
        let each = panels.map(|(i, j)| {
            integrate(12, cut(u, i), |u| {
                integrate(12, cut(v, j), |v| density.value(u, v))
            })
        });
        each.sum()
    }

    #[test]
    fn rectangles_of_any_size() {
        for power in [-0.5, 0.0, 0.5, 1.5, 2.0, 2.2, 4.5, 40.0] {
            let integrator = Integrator::new(power, [0.0; 2]);
            let density = density(&integrator);
            for sides in [
                [[-0.1, 0.1], [-0.1, 0.1]],
                [[0.2, 0.7], [-0.9, 0.3]],
                [[1.0, 1.2], [0.5, 0.9]],
                [[0.3, 0.301], [0.2, 0.25]],
                [[-3.0, 2.0], [-1.0, 4.0]],
            ] {
                let error = density.rectangle(sides) / brute(&density, sides) - 1.0;
                assert!(error.abs() < 3e-12, "{power} {sides:?} {error:e}"); // see `NATS`
            }
        }
    }

    #[test]
    fn gratings_of_any_frequency() {
        for frequency in [1.0, 10.0, 60.0] {
            let integrator = Integrator::new(2.0, [frequency, 0.3 * frequency]);
            let grating = |axis: usize, frequency, phase| Grating {
                axis,
                frequency,
                modulation: 0.9,
                phase,
            };
            let gratings = vec![
                grating(0, frequency, 0.4),
                grating(1, -0.3 * frequency, 1.1),
            ];
            let density = ReceiverDensity {
                integrator: &integrator,
                gratings,
            };
            for sides in [[[-0.2, 0.25], [-0.1, 0.3]], [[0.3, 0.8], [0.2, 0.21]]] {
                let error = density.rectangle(sides) / brute(&density, sides) - 1.0;
                // The tolerance is three times the relative error that `NATS` stands for.
                assert!(error.abs() < 3e-12, "{frequency} {sides:?} {error:e}");
            }
        }
    }

    #[test]
    fn tiny_pieces_keep_their_digits() {
        let integrator = Integrator::new(2.0, [0.0; 2]);
        let side = 1e-7;
        let value = density(&integrator).rectangle([[0.5, 0.5 + side], [0.2, 0.2 + side]]);
        let expected = side * side / 1.29_f64.powi(2);
        assert!((value / expected - 1.0).abs() < 1e-6); // the lobe varies this much over the side
    }
}
