//! Rays from the light with their shares of emission coordinates.

use super::emission::point_of;
use super::region::{Field, Finder};
use super::sums::Node;
use crate::quadrature::gauss_legendre;
use crate::shadow::{Seen, open};
use etendue_field::{Shape, SliceGrid};
use rayon::prelude::*;

/// How many nodes along each coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Rule {
    /// Over an area light: Gauss rules, exact for polynomials of degree 2 `outer` − 1; 1 for other lights.
    pub(super) outer: usize,
    /// Over the inner coordinates: a midpoint rule over the region, at whose border nothing is left.
    pub(super) inner: usize,
}

/// Most nodes of a rule.
pub(super) const MOST_NODES: usize = 4_000_000;
/// Fewest nodes along an inner coordinate.
const FEWEST: f64 = 16.0;
/// Fewest along a side of an opaque rectangle: a Gauss rule, exact where a rule without edges would be.
const FEWEST_INSIDE: f64 = 6.0;
/// Fewest along a side of an area light.
const FEWEST_OUTSIDE: f64 = 4.0;

impl Rule {
    /// The number of nodes, those outside the window included.
    pub(super) fn nodes(&self) -> usize {
        self.outer * self.outer * self.inner * self.inner
    }

    /// A rule with a ninth of the nodes where there are millions, behind an area light.
    pub(super) fn coarse(self) -> Self {
        if self.outer == 1 {
            return self;
        }
        Self {
            outer: self.outer.div_ceil(2),
            inner: (2 * self.inner).div_ceil(3),
        }
    }
}

impl<F: Field> Finder<'_, F> {
    /// All rays that land in the window. Always in the same order.
    pub(super) fn nodes(&self, rule: Rule) -> Vec<Node> {
        let points = match &self.emission.shape {
            None => vec![([0.0; 2], 1.0)],
            Some(shape) => points(shape, rule.outer),
        };
        let nested: Vec<Vec<Node>> = points
            .into_par_iter()
            .map(|(from, share)| self.nodes_from(from, share, rule.inner))
            .collect();
        nested.into_iter().flatten().collect()
    }

    fn nodes_from(&self, from: [f64; 2], share: f64, count: usize) -> Vec<Node> {
        let Some([a, b]) = self.region(from) else {
            return Vec::new();
        };
        let [da, db] = [a, b].map(|[low, high]| (high - low) / count as f64);
        let row = |i: usize| {
            let at = a[0] + (i as f64 + 0.5) * da;
            let ray = move |j: usize| self.ray(from, [at, b[0] + (j as f64 + 0.5) * db]);
            let nodes = (0..count).map(move |j| self.node(ray(j), share * da * db));
            nodes.filter(|node| node.weight != 0.0)
        };
        let mut nodes: Vec<Node> = (0..count).into_par_iter().flat_map_iter(row).collect();
        for (sign, sides) in open([a, b], &self.seen(from)).into_iter().skip(1) {
            let along = |axis: usize| {
                let ([low, high], whole) = (sides[axis], [a, b][axis]);
                let share = (high - low) / (whole[1] - whole[0]);
                let count = nodes_inside(share, count);
                let nodes = gauss_legendre(count).into_iter();
                nodes.map(move |(t, w)| {
                    (low + 0.5 * (t + 1.0) * (high - low), 0.5 * (high - low) * w)
                })
            };
            let second: Vec<(f64, f64)> = along(1).collect();
            let part = along(0).flat_map(|(at, p)| {
                let ray = move |b: f64| self.ray(from, [at, b]);
                second
                    .iter()
                    .map(move |&(b, q)| self.node(ray(b), sign * share * p * q))
            });
            nodes.extend(part.filter(|node| node.weight != 0.0));
        }
        nodes
    }

    /// Opaque masks as rays from a point of the light see them.
    pub(super) fn seen(&self, from: [f64; 2]) -> Vec<Seen<'_>> {
        let is_beam = self.emission.inner[0] == 0;
        let masks = self.opaque.iter();
        masks
            .map(|(distance, mask)| Seen {
                mask,
                origin: if is_beam { [0.0; 2] } else { from },
                scale: if is_beam { 1.0 } else { *distance },
            })
            .collect()
    }

    /// A rule that should do for a grid: a midpoint rule integrates exactly what has fewer cycles than nodes.
    pub(super) fn rule(&self, grid: &SliceGrid) -> Rule {
        let [rho, nu] = [grid.rho.max(), grid.nu.max()];
        let window = [self.window.x, self.window.y, self.window.u, self.window.v];
        // Cycles per unit of a coordinate at the light, in phases and in the window.
        let cycles = |k: usize| {
            let column = self.jacobian.map(|row| row[k]);
            let phase = rho * column[0].hypot(column[1]) + nu * column[2].hypot(column[3]);
            let widths = column.iter().zip(window);
            let window = widths.map(|(c, profile)| c.abs() / profile.half_width());
            phase + window.fold(0.0, f64::max)
        };
        let inner = self.region([0.0; 2]).map_or(FEWEST, |region| {
            let along = |axis: usize| {
                let [low, high] = region[axis];
                let frequency = cycles(self.emission.inner[axis]) + self.emission.cycles[axis];
                (high - low) * frequency
            };
            FEWEST + along(0).max(along(1))
        });
        let outer = self.emission.shape.map_or(1.0, |shape| {
            let [w, h] = shape.bounds().size;
            // A Gauss rule needs π/2 nodes for a cycle, and then a few.
            FEWEST_OUTSIDE + 1.6 * (w * cycles(0)).max(h * cycles(1))
        });
        let mut rule = Rule {
            outer: whole_number(outer),
            inner: whole_number(inner),
        };
        while rule.nodes() > MOST_NODES {
            rule = Rule {
                outer: (rule.outer * 7 / 8).max(1),
                inner: rule.inner * 7 / 8,
            };
        }
        rule
    }
}

/// Along a side of an opaque rectangle that takes a share of the region's.
pub(super) fn nodes_inside(share: f64, count: usize) -> usize {
    whole_number(FEWEST_INSIDE + 1.6 * share * count as f64)
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "not negative; beyond 10⁴ it is cut down"
)]
fn whole_number(x: f64) -> usize {
    x.ceil().clamp(1.0, 1e4) as usize
}

/// A Gauss rule over a shape. Over a disc: in r², and equal angles.
fn points(shape: &Shape, count: usize) -> Vec<([f64; 2], f64)> {
    let unit = |n: usize| {
        let nodes = gauss_legendre(n).into_iter();
        nodes.map(|(x, weight)| (0.5 * (x + 1.0), 0.5 * weight))
    };
    let second: Vec<(f64, f64)> = match shape {
        Shape::Rectangle(_) => unit(count).collect(),
        Shape::Disc(_) => {
            let angles = 2 * count;
            let share = 1.0 / angles as f64;
            (0..angles).map(|i| (i as f64 * share, share)).collect()
        }
    };
    let first = match shape {
        Shape::Rectangle(_) => count,
        Shape::Disc(_) => count.div_ceil(2),
    };
    let pairs = unit(first).flat_map(|(a, p)| second.iter().map(move |&(b, q)| ([a, b], p * q)));
    pairs
        .map(|(at, share)| (point_of(shape, at), share * shape.area()))
        .collect()
}
