//! Sets of slopes: intersections of a rectangle and discs.

use super::density::ReceiverDensity;
use super::slopes::SlopeProjection;
use crate::barrier::{Barrier, Bounds};
use etendue_field::{Disc, Shape, whole};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Discs whose centres and radii differ by less than this fraction of the radius are treated as
/// equal.
const SAME_RADIUS: f64 = 1e-12;

/// The set of slopes in the intersection of a rectangle and discs.
#[derive(Clone, Debug)]
pub(crate) struct ReceiverRegion {
    /// The rectangle's bounds, which may be infinite if the intersection includes discs.
    sides: Bounds,
    discs: Vec<Disc>,
}

impl ReceiverRegion {
    /// The region that consists of a rectangle.
    pub(crate) fn rectangle(sides: Bounds) -> Self {
        Self {
            sides,
            discs: vec![],
        }
    }

    /// The region that consists of a rectangle or a disc.
    pub(crate) fn shape(shape: &Shape) -> Self {
        match *shape {
            Shape::Rectangle(r) => Self::rectangle([r.extent(0), r.extent(1)]),
            Shape::Disc(disc) => Self {
                sides: [[f64::NEG_INFINITY, f64::INFINITY]; 2],
                discs: vec![disc],
            },
        }
    }

    /// A rectangle that contains the region: the intersection of the rectangle and the
    /// bounding boxes of the discs.
    pub(crate) fn bounds(&self) -> Bounds {
        let discs = self.discs.iter().map(|disc| {
            let bounds = Shape::Disc(*disc).bounds();
            [bounds.extent(0), bounds.extent(1)]
        });
        discs.fold(self.sides, common)
    }

    /// The intersection of the region with a rectangle, or `None` if this intersection is
    /// empty.
    pub(crate) fn within(&self, sides: Bounds) -> Option<Self> {
        let region = Self {
            sides: common(self.sides, sides),
            discs: self.discs.clone(),
        };
        region.simplified()
    }

    /// The intersection of the region with a shape, or `None` if this intersection is
    /// empty.
    pub(crate) fn cut(&self, shape: &Shape) -> Option<Self> {
        match *shape {
            Shape::Rectangle(r) => self.within([r.extent(0), r.extent(1)]),
            Shape::Disc(disc) => {
                let mut region = self.clone();
                region.discs.push(disc);
                region.simplified()
            }
        }
    }

    /// The part of the region that the half-planes of a barrier, or the screen around its
    /// hole, leave open. Returns `None` if this part is empty.
    pub(super) fn open(&self, bundle: &SlopeProjection, barrier: &Barrier<'_>) -> Option<Self> {
        let before = barrier.distance;
        match barrier.disc_hole() {
            Some(disc) => self.cut(&bundle.seen(disc, before)),
            None => self.within(bundle.slopes(barrier.open, before)),
        }
    }

    /// Removes discs that contain the rectangle or another disc. Returns `None` if two discs, or a
    /// disc and the rectangle, do not overlap.
    fn simplified(mut self) -> Option<Self> {
        let [u, v] = self.sides;
        if u[0] >= u[1] || v[0] >= v[1] {
            return None;
        }
        let mut kept: Vec<Disc> = Vec::new();
        for disc in self.discs {
            let [near, far] = distances(self.sides, disc.center);
            if near >= disc.radius {
                return None;
            }
            if far <= disc.radius || kept.iter().any(|k| holds(&disc, k)) {
                continue;
            }
            if kept.iter().any(|k| apart(&disc, k)) {
                return None;
            }
            kept.retain(|k| !holds(k, &disc));
            kept.push(disc);
        }
        self.discs = kept;
        Some(self)
    }

    /// The integral of a density over the region.
    ///
    /// By Green's theorem the integral over the region is ∮ A dv along its boundary, where A(u, v)
    /// = ∫ density du. The boundary consists of arcs of circles, on which the integrand is smooth,
    /// and of vertical edges of the rectangle (docs/theory.md, formula 16).
    pub(crate) fn integral(&self, density: &ReceiverDensity<'_>) -> f64 {
        let Some(first) = self.discs.first() else {
            return density.rectangle(self.sides);
        };
        let from = first.center[0];
        let arcs = (0..self.discs.len()).map(|i| self.arcs(i, from, density));
        let [left, right] = self.sides[0].map(|u| self.edge(u, from, density));
        arcs.sum::<f64>() + right - left
    }

    /// Estimates the number of computing steps of [`Self::integral`], as if each whole circle were
    /// part of the boundary.
    pub(crate) fn steps(&self, density: &ReceiverDensity<'_>) -> f64 {
        if self.discs.is_empty() {
            return density.steps(self.sides);
        }
        let bounds = self.bounds();
        let circle = |disc: &Disc| {
            let (panels, rule) = density.arc(FRAC_PI_2 * disc.radius);
            4.0 * panels as f64 * rule.len() as f64
        };
        let nodes: f64 = self.discs.iter().map(circle).sum();
        let edges = 2.0 * density.steps(bounds);
        nodes * density.steps_along_u(bounds[0][1] - bounds[0][0]) + edges
    }

    /// ∫ A dv upward along the line of constant u. The integral is over the part of this
    /// line that is inside all discs and between the rectangle's lower and upper sides.
    fn edge(&self, u: f64, from: f64, density: &ReceiverDensity<'_>) -> f64 {
        let chords = self.discs.iter().map(|disc| {
            let across = u - disc.center[0];
            let half = (disc.radius * disc.radius - across * across).sqrt();
            // If the line misses the disc, `half` is NaN, and the final comparison is false.
            [disc.center[1] - half, disc.center[1] + half]
        });
        let mut part = self.sides[1];
        for [low, high] in chords {
            if low.is_nan() {
                return 0.0;
            }
            part = [part[0].max(low), part[1].min(high)];
        }
        if part[0] < part[1] {
            density.rectangle([[from, u], part])
        } else {
            0.0
        }
    }

    /// ∫ A dv along the arcs of circle `i` that bound the region.
    fn arcs(&self, i: usize, from: f64, density: &ReceiverDensity<'_>) -> f64 {
        let disc = self.discs[i];
        let ends = self.crossings(i);
        let arcs = (0..ends.len()).map(|k| match ends.get(k + 1) {
            Some(&next) => [ends[k], next],
            None => [ends[k], ends[0] + TAU],
        });
        let inside = arcs.filter(|[start, end]| {
            let [u, v] = on(&disc, 0.5 * (start + end));
            let mut others = self.discs.iter().enumerate().filter(|(j, _)| *j != i);
            contains(self.sides, u, v) && others.all(|(_, d)| d.contains(u, v))
        });
        inside.map(|arc| along(&disc, arc, from, density)).sum()
    }

    /// The angles, in ascending order, at which circle `i` may enter or leave the
    /// intersection of the rectangle and the other discs. Returns at least one angle.
    fn crossings(&self, i: usize) -> Vec<f64> {
        let disc = &self.discs[i];
        let mut angles = vec![0.0];
        for side in self.sides[0] {
            let angle = libm::acos((side - disc.center[0]) / disc.radius);
            angles.extend([angle, -angle]);
        }
        for side in self.sides[1] {
            let angle = libm::asin((side - disc.center[1]) / disc.radius);
            angles.extend([angle, 2.0 * FRAC_PI_2 - angle]);
        }
        for (_, other) in self.discs.iter().enumerate().filter(|(j, _)| *j != i) {
            let [du, dv] = [0, 1].map(|k| other.center[k] - disc.center[k]);
            let (r, s, d) = (disc.radius, other.radius, libm::hypot(du, dv));
            let half = libm::acos((d * d + r * r - s * s) / (2.0 * d * r));
            let middle = libm::atan2(dv, du);
            angles.extend([middle - half, middle + half]);
        }
        // If two circles, or a circle and a side, do not cross, their angles are NaN and are
        // removed.
        angles.retain(|a| a.is_finite());
        angles.iter_mut().for_each(|a| *a = a.rem_euclid(TAU));
        angles.sort_by(f64::total_cmp);
        angles
    }
}

/// ∫ A dv along an arc of a circle, for the antiderivative A that is zero at u = `from`.
fn along(disc: &Disc, [start, end]: [f64; 2], from: f64, density: &ReceiverDensity<'_>) -> f64 {
    let quarters = whole(((end - start) / FRAC_PI_2).ceil().max(1.0));
    let (panels, rule) = density.arc(disc.radius * (end - start) / quarters as f64);
    let parts = quarters * panels;
    let half = 0.5 * (end - start) / parts as f64;
    let nodes = (0..parts).flat_map(|k| {
        let middle = start + (2 * k + 1) as f64 * half;
        rule.iter()
            .map(move |&(t, w)| (middle + half * t, half * w))
    });
    nodes
        .map(|(angle, weight)| {
            let [u, v] = on(disc, angle);
            density.along_u([from, u], v) * (disc.radius * libm::cos(angle) * weight)
        })
        .sum()
}

/// The point of a disc's boundary at an angle.
fn on(disc: &Disc, angle: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(angle);
    [
        disc.center[0] + disc.radius * cos,
        disc.center[1] + disc.radius * sin,
    ]
}

fn contains([u, v]: Bounds, x: f64, y: f64) -> bool {
    u[0] <= x && x <= u[1] && v[0] <= y && y <= v[1]
}

fn common(a: Bounds, b: Bounds) -> Bounds {
    [0, 1].map(|k| [a[k][0].max(b[k][0]), a[k][1].min(b[k][1])])
}

/// The distances of a point from the nearest and the farthest point of a rectangle.
fn distances(sides: Bounds, point: [f64; 2]) -> [f64; 2] {
    let along = [0, 1].map(|k| {
        let [below, above] = [sides[k][0] - point[k], point[k] - sides[k][1]];
        [below.max(above).max(0.0), (-below).max(-above)]
    });
    [0, 1].map(|end| libm::hypot(along[0][end], along[1][end]))
}

/// Checks whether the disc `large` contains or equals the disc `small`.
fn holds(large: &Disc, small: &Disc) -> bool {
    distance(large, small) + small.radius <= large.radius * (1.0 + SAME_RADIUS)
}

fn apart(a: &Disc, b: &Disc) -> bool {
    distance(a, b) >= a.radius + b.radius
}

fn distance(a: &Disc, b: &Disc) -> f64 {
    libm::hypot(a.center[0] - b.center[0], a.center[1] - b.center[1])
}
