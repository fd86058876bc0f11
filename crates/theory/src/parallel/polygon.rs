//! Convex polygons in the (position, slope) plane of one axis, and their exact Fourier transforms
//! (docs/theory.md (5)).
//!
//! Coordinates are in units of the window's half-widths, so they are of order 1.

use etendue_field::{Complex, cis, sinc};
use std::f64::consts::TAU;

/// The largest phase, in radians, for which the power series is used. Above this phase, the sum
/// over edges is accurate to 14 digits.
const SERIES_PHASE: f64 = 0.2;
/// Number of terms of the power series; the next term is SERIES_PHASE¹¹ · 12/13! = 4e-17 of the
/// area.
const SERIES_TERMS: u32 = 11;

/// A corner of a polygon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Vertex {
    /// The coordinates (position, slope).
    pub(crate) at: [f64; 2],
    /// The direction of the edge from this corner to the next corner. It is an index into a list of
    /// directions that many polygons share.
    pub(crate) edge: usize,
}

/// A convex polygon or a segment. The corners of a polygon are in counter-clockwise order, and the
/// two corners of a segment are in order of increasing slope.
///
/// A segment along (shear, 1) represents δ(position − shear · slope), so integrals along the
/// segment are over the slope.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Polygon(Vec<Vertex>);

pub(crate) fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

pub(crate) fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

impl Polygon {
    /// The square |position| < 1, |slope| < 1. `edges` contains the indices of two
    /// directions: first the direction of the sides with constant slope, then the direction of the
    /// sides with constant position.
    pub(crate) fn square(edges: [usize; 2]) -> Self {
        let corner = |x, u, side: usize| Vertex {
            at: [x, u],
            edge: edges[side],
        };
        Self(vec![
            corner(-1.0, -1.0, 0),
            corner(1.0, -1.0, 1),
            corner(1.0, 1.0, 0),
            corner(-1.0, 1.0, 1),
        ])
    }

    /// The segment position = `shear` · slope inside the square; `edge` is the index of
    /// the direction (shear, 1).
    pub(crate) fn segment(shear: f64, edge: usize) -> Self {
        let end = 1.0 / shear.abs().max(1.0);
        let corner = |u: f64| Vertex {
            at: [shear * u, u],
            edge,
        };
        Self(vec![corner(-end), corner(end)])
    }

    pub(crate) fn is_segment(&self) -> bool {
        self.0.len() == 2
    }

    pub(crate) fn corners(&self) -> &[Vertex] {
        &self.0
    }

    /// Each corner with its successor.
    fn sides(&self) -> impl Iterator<Item = (Vertex, Vertex)> {
        let next = self.0.iter().cycle().skip(1);
        self.0.iter().copied().zip(next.copied())
    }

    /// The part of the polygon where `normal`·p ≤ `bound`; `edge` is the index of the
    /// direction of the cut (Sutherland and Hodgman 1974).
    pub(crate) fn clipped(&self, normal: [f64; 2], bound: f64, edge: usize) -> Self {
        if self.is_segment() {
            return self.shortened(normal, bound);
        }
        let mut kept = Vec::with_capacity(self.0.len() + 1);
        for (a, b) in self.sides() {
            let inside = [a, b].map(|corner| bound - dot(normal, corner.at));
            let leaves = inside[0] >= 0.0 && inside[1] < 0.0;
            let enters = inside[0] < 0.0 && inside[1] >= 0.0;
            if inside[0] >= 0.0 {
                kept.push(a);
            }
            if leaves || enters {
                let t = inside[0] / (inside[0] - inside[1]);
                let step = minus(b.at, a.at);
                kept.push(Vertex {
                    at: [a.at[0] + t * step[0], a.at[1] + t * step[1]],
                    edge: if leaves { edge } else { a.edge },
                });
            }
        }
        Self(kept)
    }

    /// The part of a segment where `normal`·p ≤ `bound`.
    fn shortened(&self, normal: [f64; 2], bound: f64) -> Self {
        let [a, b] = [self.0[0], self.0[1]];
        let inside = [a, b].map(|corner| bound - dot(normal, corner.at));
        if inside.iter().all(|&i| i >= 0.0) {
            return self.clone();
        }
        if inside.iter().all(|&i| i < 0.0) {
            return Self(Vec::new());
        }
        let t = inside[0] / (inside[0] - inside[1]);
        let step = minus(b.at, a.at);
        let cut = Vertex {
            at: [a.at[0] + t * step[0], a.at[1] + t * step[1]],
            edge: a.edge,
        };
        let first_stays = inside[0] >= 0.0;
        Self(if first_stays {
            vec![a, cut]
        } else {
            vec![cut, b]
        })
    }

    /// The part of the polygon where `low` ≤ position − `shear` · slope ≤ `high`; `edge`
    /// is the index of the direction (shear, 1).
    pub(crate) fn strip(&self, shear: f64, [low, high]: [f64; 2], edge: usize) -> Self {
        self.clipped([1.0, -shear], high, edge)
            .clipped([-1.0, shear], -low, edge)
    }

    /// Divides the polygon into triangles (a, b, c), where a is the first corner of the polygon.
    /// Returns the vectors from a to b and from a to c for each triangle.
    pub(crate) fn triangles(&self) -> impl Iterator<Item = [[f64; 2]; 2]> {
        self.0
            .windows(2)
            .skip(1)
            .map(|pair| [pair[0], pair[1]].map(|corner| minus(corner.at, self.0[0].at)))
    }

    /// The area of a polygon, or the range of slopes of a segment.
    pub(crate) fn measure(&self) -> f64 {
        if self.is_segment() {
            return minus(self.0[1].at, self.0[0].at)[1];
        }
        self.triangles().map(|[b, c]| 0.5 * cross(b, c)).sum()
    }

    /// The Fourier transform F(k) = ∫∫ exp(−2πi k·p) over the polygon, accurate to about
    /// 1e-14; F(0) is the polygon's measure.
    pub(crate) fn transform(&self, k: [f64; 2]) -> Complex {
        let Some(first) = self.0.first() else {
            return Complex::ZERO;
        };
        if self.is_segment() {
            return self.segment_transform(k);
        }
        let phase = |corner: &Vertex| TAU * dot(k, minus(corner.at, first.at)).abs();
        if self.0.iter().map(phase).fold(0.0, f64::max) < SERIES_PHASE {
            self.series(k) * cis(-TAU * dot(k, first.at))
        } else {
            self.edge_form(k)
        }
    }

    /// The transform of a polygon. For a parallelogram with sides a and b and centre c, the
    /// transform is exp(−2πi k·c) sinc(k·a) sinc(k·b) times the area. This formula needs half as
    /// many exponentials as [`transform`](Self::transform).
    pub(crate) fn transform_by_sides(&self, k: [f64; 2]) -> Complex {
        let [p, q, r, s] = &self.0[..] else {
            return self.transform(k);
        };
        if p.edge != r.edge || q.edge != s.edge {
            return self.transform(k);
        }
        let (a, b) = (minus(q.at, p.at), minus(r.at, q.at));
        let center = [0, 1].map(|i| 0.5 * (p.at[i] + r.at[i]));
        let size = cross(a, b) * sinc(dot(k, a)) * sinc(dot(k, b));
        cis(-TAU * dot(k, center)) * size
    }

    /// The transform of a segment e with midpoint c, which is exp(−2πi k·c) sinc(k·e) times
    /// the range of slopes.
    fn segment_transform(&self, k: [f64; 2]) -> Complex {
        let [a, b] = [self.0[0].at, self.0[1].at];
        let e = minus(b, a);
        let middle = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
        cis(-TAU * dot(k, middle)) * (e[1] * sinc(dot(k, e)))
    }

    /// The transform by the divergence theorem with the field k exp(−2πi k·p): i/(2π|k|²) Σ
    /// (n·k) exp(−2πi k·c) sinc(k·e). The sum is over the edges e, with midpoints c and outward
    /// normals n = (e_y, −e_x).
    fn edge_form(&self, k: [f64; 2]) -> Complex {
        let mut sum = Complex::ZERO;
        for (a, b) in self.sides() {
            let e = minus(b.at, a.at);
            let middle = [0.5 * (a.at[0] + b.at[0]), 0.5 * (a.at[1] + b.at[1])];
            sum += cis(-TAU * dot(k, middle)) * (cross(k, e) * sinc(dot(k, e)));
        }
        sum * Complex::new(0.0, 1.0 / (TAU * dot(k, k)))
    }

    /// The transform about the first corner. For each triangle, the transform is a power
    /// series in the phases β and γ of the other two corners: 2 area Σ (−i)ⁿ hₙ(β, γ)/(n + 2)!,
    /// where hₙ = βⁿ + βⁿ⁻¹γ + … + γⁿ.
    fn series(&self, k: [f64; 2]) -> Complex {
        let mut sum = Complex::ZERO;
        for [b, c] in self.triangles() {
            let (beta, gamma) = (TAU * dot(k, b), TAU * dot(k, c));
            let mut factor = Complex::new(0.5 * cross(b, c), 0.0);
            let (mut h, mut power) = (1.0, 1.0);
            for n in 0..SERIES_TERMS {
                sum += factor * h;
                power *= beta;
                h = gamma * h + power;
                factor *= Complex::new(0.0, -1.0 / f64::from(n + 3));
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FREQUENCIES: [[f64; 2]; 8] = [
        [0.0, 0.0],
        [1e-9, -3e-8],
        [0.0, 0.011],
        [0.02, 1e-3],
        [0.3, 0.0],
        [0.0, -1.7],
        [1.3, 2.1],
        [7.0, -0.5],
    ];

    /// The transform of the square |p| < 1.
    fn square_transform(k: [f64; 2]) -> f64 {
        4.0 * sinc(2.0 * k[0]) * sinc(2.0 * k[1])
    }

    #[test]
    fn square_is_a_product_of_sincs() {
        for k in FREQUENCIES {
            let f = Polygon::square([0, 1]).transform(k);
            assert!((f - square_transform(k)).norm() < 1e-14); // rounding, area 4
        }
    }

    #[test]
    fn parts_add_up() {
        let whole = Polygon::square([0, 1]);
        let (normal, bound) = ([0.8, -0.7], 0.31);
        let part = whole.clipped(normal, bound, 2);
        let rest = whole.clipped(normal.map(|n| -n), -bound, 2);
        assert!((part.measure() + rest.measure() - 4.0).abs() < 1e-14); // rounding
        for k in FREQUENCIES {
            let sum = part.transform(k) + rest.transform(k);
            assert!((sum - square_transform(k)).norm() < 2e-14); // rounding, area 4
        }
    }

    #[test]
    fn series_and_edge_form_agree_where_they_meet() {
        let triangle = Polygon::square([0, 1]).clipped([1.0, 2.0], -1.0, 2);
        for angle in 0..20 {
            let direction = cis(0.3 * f64::from(angle));
            let k = [direction.re, direction.im].map(|c| c * SERIES_PHASE / (TAU * 3.0));
            let corner = triangle.0[0].at;
            let series = triangle.series(k) * cis(-TAU * dot(k, corner));
            // At a phase of 0.1 the terms of the edge form, which are about 1, cancel to an error
            // of about ten rounding errors.
            assert!((series - triangle.edge_form(k)).norm() < 1e-14);
        }
    }

    #[test]
    fn segment_is_the_limit_of_a_strip() {
        let (shear, cut) = (1.7, [[0.4, 1.0], [0.9, -0.2]]);
        let width = 1e-5;
        let strip = Polygon::square([0, 1]).strip(shear, [-0.5 * width, 0.5 * width], 2);
        let cuts = |p: Polygon| p.clipped(cut[0], 0.3, 3).clipped(cut[1], 0.2, 4);
        let (strip, segment) = (cuts(strip), cuts(Polygon::segment(shear, 2)));
        // The slanted ends of the strip cause an error of second order in its width, about 1e-10,
        // and rounding causes an error of 1e-16/width.
        assert!((strip.measure() / width - segment.measure()).abs() < 1e-9);
        for k in FREQUENCIES {
            let difference = strip.transform(k) / width - segment.transform(k);
            assert!(difference.norm() < 1e-8, "{}", difference.norm()); // (π · 7 · width)²/6 = 1e-8
        }
    }

    #[test]
    fn nothing_is_left_outside() {
        let none = Polygon::square([0, 1]).clipped([1.0, 0.0], -2.0, 2);
        assert!(none.corners().is_empty());
        assert!(none.transform([1.0, 1.0]).norm() < f64::MIN_POSITIVE);
    }
}
