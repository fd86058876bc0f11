//! Searches the emission's inner coordinates for the region whose rays land in a window.

use super::emission::EmissionMeasure;
use crate::geometry::Matrix;
use crate::nets::RayNode;
use crate::path::PathSystem;
use crate::plane::Plane;
use etendue_field::{TwoPlane, Window};

/// A box in two coordinates, given by the lowest and highest value of each coordinate.
pub(super) type Region = [[f64; 2]; 2];

/// A light field as a function of rays. The function takes a ray (x, y, u, v) at the light. It
/// returns the ray's coordinates at the plane. It also returns the ray's contribution to ray space
/// at the plane, per unit of the emission's coordinates. The function returns `None` if the ray
/// does not arrive.
pub(super) trait RayField: Fn([f64; 4]) -> Option<([f64; 4], f64)> + Sync {}
impl<F: Fn([f64; 4]) -> Option<([f64; 4], f64)> + Sync> RayField for F {}

/// Number of cells along each side of the box in which rays are sought.
const CELLS: usize = 32;
/// Rays are ignored if their contribution is less than this fraction of the strongest ray's
/// contribution.
const MIN_SHARE: f64 = 1e-13;
/// Number of bisections that locate an edge in a cell up to rounding error.
const HALVINGS: usize = 40;
/// Maximum number of boxes that the search tries. After this number, the search returns the last
/// box.
const ROUNDS: usize = 24;
/// Width of the first box relative to the window.
const MARGIN: f64 = 1.5;

/// Finds the region of rays that land in a window.
pub(super) struct Finder<'a, F> {
    pub(super) field: &'a F,
    pub(super) window: &'a Window,
    pub(super) emission: EmissionMeasure,
    pub(super) neighbourhood: Neighbourhood,
}

/// The point where the central ray lands, and a derivative. It is the derivative of a ray's landing
/// point with respect to the ray at the light. Rows are coordinates at the plane, and columns are
/// coordinates at the light.
pub(super) type Neighbourhood = ([f64; 4], Matrix<4>);

/// The neighbourhood from exact rays without masks, or `None` if the central ray or one of
/// its neighbours does not arrive.
pub(super) fn neighbourhood(system: &PathSystem, plane: &Plane) -> Option<Neighbourhood> {
    const STEP: f64 = 1e-6;
    let lands = |ray| Some(plane.coordinates(&system.follow(ray)?)?.0);
    let mut jacobian = [[0.0; 4]; 4];
    for column in 0..4 {
        let beside = |side: f64| {
            let mut ray = [0.0; 4];
            ray[column] = side * STEP;
            lands(ray)
        };
        let (above, below) = (beside(1.0)?, beside(-1.0)?);
        for row in 0..4 {
            jacobian[row][column] = (above[row] - below[row]) / (2.0 * STEP);
        }
    }
    Some((lands([0.0; 4])?, jacobian))
}

impl<F: RayField> Finder<'_, F> {
    /// The ray at coordinates (a, b) of the emission.
    pub(super) fn ray(&self, inner: [f64; 2]) -> [f64; 4] {
        let mut ray = [0.0; 4];
        ray[self.emission.inner[0]] = inner[0];
        ray[self.emission.inner[1]] = inner[1];
        ray
    }

    /// A ray at the plane. Its weight includes the window and `share`, the area of
    /// emission coordinates that the ray represents.
    pub(super) fn node(&self, ray: [f64; 4], share: f64) -> RayNode {
        let (z, weight) = (self.field)(ray).unwrap_or(([0.0; 4], 0.0));
        let [x, y, u, v] = z;
        let weight = share * weight * self.window.value(&TwoPlane { x, y, u, v });
        RayNode { z, weight }
    }

    /// The region of rays that land in the window. The search starts from the bounding box
    /// of the parallelogram that the linear map takes into the window. The search then moves,
    /// widens and narrows the box until the box contains all arriving light. Returns `None` if
    /// nothing arrives.
    pub(super) fn region(&self) -> Option<Region> {
        let mut region = self.linear_region()?;
        let reach = self.emission.reach;
        for _ in 0..ROUNDS {
            let Some(lit) = self.lit(&region) else {
                let grown = widened(&region, [[1.0; 2]; 2], reach);
                if grown == region {
                    return None;
                }
                region = grown;
                continue;
            };
            // Where light touches the border of the region, there may be light beyond it.
            let touches = |axis: usize| {
                let [low, high] = lit[axis];
                let [least, most] = region[axis];
                let limit = reach[axis] * (1.0 - 1e-9);
                [
                    low == 0 && least > -limit,
                    high + 1 == CELLS && most < limit,
                ]
            };
            let growth =
                [touches(0), touches(1)].map(|sides| sides.map(|t| f64::from(u8::from(t)) * 0.5));
            let grows = growth.as_flattened().iter().any(|g| *g > 0.0);
            let next = if grows {
                widened(&region, growth, reach)
            } else {
                narrowed(&region, &lit)
            };
            let tight = lit.iter().all(|[low, high]| 2 * (high - low + 3) >= CELLS);
            region = next;
            if !grows && tight {
                return Some(region);
            }
        }
        Some(region)
    }

    /// The absolute value of a ray's contribution to the windowed ray space. The ray is
    /// given by inner coordinates of the emission.
    fn strength(&self, inner: [f64; 2]) -> f64 {
        self.node(self.ray(inner), 1.0).weight.abs()
    }

    /// The strength of light next to edges that cut the light, divided by the strength of
    /// all light in a row of cells. This ratio, divided by the number of nodes along a coordinate,
    /// bounds the error of a rule.
    pub(super) fn edges(&self) -> f64 {
        let Some(region) = self.region() else {
            return 0.0;
        };
        let at = |k: usize| middle(&region, (k / CELLS, k % CELLS));
        let strengths: Vec<f64> = (0..CELLS * CELLS).map(|k| self.strength(at(k))).collect();
        let dark = MIN_SHARE * strengths.iter().copied().fold(0.0, f64::max);
        let inner = |(i, j): &(usize, usize)| i + 1 < CELLS && j + 1 < CELLS;
        let pairs = cells().filter(inner).flat_map(|(i, j)| {
            let here = i * CELLS + j;
            [[here, here + 1], [here, here + CELLS]]
        });
        let of_pair = |pair: [usize; 2]| {
            let [a, b] = pair.map(|k| strengths[k] > dark);
            let [lit, unlit] = if a { pair } else { [pair[1], pair[0]] };
            (a != b).then(|| self.last_lit(at(lit), at(unlit), dark))
        };
        let next_to_edges: f64 = pairs.filter_map(of_pair).sum();
        next_to_edges / strengths.iter().sum::<f64>() * CELLS as f64
    }

    /// The strength of light at the lit side of the edge between a lit point and a dark
    /// point.
    fn last_lit(&self, mut lit: [f64; 2], mut unlit: [f64; 2], dark: f64) -> f64 {
        for _ in 0..HALVINGS {
            let between = [0, 1].map(|axis| 0.5 * (lit[axis] + unlit[axis]));
            if self.strength(between) > dark {
                lit = between;
            } else {
                unlit = between;
            }
        }
        self.strength(lit)
    }

    /// The indices of the first and the last lit cell of a region along each axis.
    fn lit(&self, region: &Region) -> Option<[[usize; 2]; 2]> {
        let strengths: Vec<f64> = cells()
            .map(|cell| self.strength(middle(region, cell)))
            .collect();
        let most = strengths.iter().copied().fold(0.0, f64::max);
        let mut found: Option<[[usize; 2]; 2]> = None;
        for ((i, j), strength) in cells().zip(strengths) {
            if strength > MIN_SHARE * most {
                let [a, b] = found.unwrap_or([[i, i], [j, j]]);
                found = Some([[a[0].min(i), a[1].max(i)], [b[0].min(j), b[1].max(j)]]);
            }
        }
        found
    }

    /// The bounding box of the rays that the linear map takes into a slightly wider window.
    fn linear_region(&self) -> Option<Region> {
        let [a, b] = self.emission.reach;
        let mut corners = vec![[-a, -b], [a, -b], [a, b], [-a, b]];
        let profiles = [self.window.x, self.window.y, self.window.u, self.window.v];
        for (i, profile) in profiles.iter().enumerate() {
            let row = self.neighbourhood.1[i];
            let inner = self.emission.inner.map(|k| row[k]);
            let offset = self.neighbourhood.0[i];
            let most = MARGIN * profile.half_width();
            corners = clipped(&corners, inner, most - offset);
            corners = clipped(&corners, inner.map(|c| -c), most + offset);
        }
        let along = |axis: usize| {
            let ends = corners.iter().map(|c| c[axis]);
            [
                ends.clone().fold(f64::INFINITY, f64::min),
                ends.fold(f64::NEG_INFINITY, f64::max),
            ]
        };
        (!corners.is_empty()).then(|| [along(0), along(1)])
    }
}

/// Iterates over the indices of the cells of a region, row by row.
fn cells() -> impl Iterator<Item = (usize, usize)> {
    (0..CELLS * CELLS).map(|i| (i / CELLS, i % CELLS))
}

/// The centre of the cell (i, j) of a region.
fn middle(region: &Region, (i, j): (usize, usize)) -> [f64; 2] {
    let at = |axis: usize, i: usize| {
        let [low, high] = region[axis];
        low + (high - low) * (i as f64 + 0.5) / CELLS as f64
    };
    [at(0, i), at(1, j)]
}

/// The part of a convex polygon where n·p ≤ c.
fn clipped(corners: &[[f64; 2]], n: [f64; 2], c: f64) -> Vec<[f64; 2]> {
    let height = |p: [f64; 2]| n[0] * p[0] + n[1] * p[1] - c;
    let mut kept = Vec::new();
    for (i, &p) in corners.iter().enumerate() {
        let q = corners[(i + 1) % corners.len()];
        let (here, there) = (height(p), height(q));
        if here <= 0.0 {
            kept.push(p);
        }
        if (here < 0.0) != (there < 0.0) {
            let t = here / (here - there);
            kept.push([p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])]);
        }
    }
    kept
}

/// A region whose sides are moved outward by the given fractions of its width, but not
/// beyond `reach`.
fn widened(region: &Region, growth: [[f64; 2]; 2], reach: [f64; 2]) -> Region {
    std::array::from_fn(|axis| {
        let [low, high] = region[axis];
        let width = high - low;
        [
            (low - growth[axis][0] * width).max(-reach[axis]),
            (high + growth[axis][1] * width).min(reach[axis]),
        ]
    })
}

/// The region that contains the lit cells and a margin of one cell on each side.
fn narrowed(region: &Region, lit: &[[usize; 2]; 2]) -> Region {
    std::array::from_fn(|axis| {
        let [low, high] = region[axis];
        let cell = (high - low) / CELLS as f64;
        [
            (low + cell * (lit[axis][0] as f64 - 1.0)).max(low),
            (low + cell * (lit[axis][1] as f64 + 2.0)).min(high),
        ]
    })
}
