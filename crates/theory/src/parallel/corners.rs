//! Computes the transforms of many polygons along a row of frequencies from sums over corners. This
//! is faster than the transform of each polygon at each frequency (docs/theory.md, section 3).
//!
//! With the field k exp(−2πi k·p), formula (5) of docs/theory.md becomes a sum over the corners p
//! of the polygon. The edges that meet at p have the directions d and e:
//!
//! F(k) = 1/(4π²) Σ (d × e) / ((k·d)(k·e)) · exp(−2πi k·p)
//!
//! The quotient depends only on the pair (d, e) of directions, and a chain has few pairs of
//! directions. The exponential is the product of one exponential in the position and one in the
//! slope. Each exponential of the window shifts k by ± s. With θ = 2π s·p and the quotients c± at k
//! ± s, the contribution of a corner is as follows:
//!
//! exp(−2πi k·p) Σ_s (c₊ + c₋) cos θ + i (c₋ − c₊) sin θ.
//!
//! The end of a segment along d has the quotient ± 1/(2πi k·d).
//!
//! If (k ± s)·d is nearly zero for a direction d, the contributions of corners cancel, and
//! [`Polygon::transform`] is used instead.

use crate::parallel::expansion::AxisSection;
use crate::parallel::polygon::{self, Polygon, cross, dot};
use crate::parallel::row::{ComplexRow, FrequencyRow, add_product, add_scaled};
use crate::parallel::wave::SectionWave;
use etendue_field::Complex;
use std::f64::consts::{PI, TAU};

/// If |k·d| is at least this value for every direction, sums over corners are used. Here d is the
/// longest possible edge along the direction. If both directions of a corner are at this limit, the
/// quotient amplifies rounding errors by 1/CANCELLATION² = 1000.
const CANCELLATION: f64 = 0.03;
/// Number of waves that are processed together. The number is so small that the quotients of these
/// waves fit into the cache.
const WAVES_AT_A_TIME: usize = 32;

/// A corner of a polygon, prepared for summation.
#[derive(Debug)]
struct Corner {
    at: [f64; 2],
    /// Index of the corner's pair of directions.
    pair: usize,
    /// The sign of the corner's term, which depends on the order of the corner's two directions.
    /// For the ends of a segment, this factor is ±i.
    sign: Complex,
    /// Index of the corner's polygon.
    polygon: usize,
}

/// The corners of all polygons of a section, for a field that is multiplied by a sum of waves.
#[derive(Debug)]
pub(crate) struct Corners<'a> {
    section: &'a AxisSection,
    waves: &'a [SectionWave],
    corners: Vec<Corner>,
    /// The values (cos θ, sin θ) for each corner and each wave. The indices are [corner, wave].
    phases: Vec<[f64; 2]>,
    /// Pairs of directions of the two edges that meet at a corner, with the lower index first. For
    /// the end of a segment the two indices are equal.
    pairs: Vec<[usize; 2]>,
    /// Indices of the directions of edges. Each has a threshold of |k·d| below which k·d is treated
    /// as nearly zero.
    edges: Vec<(usize, f64)>,
}

/// The quotients of a group of waves along a row of frequencies.
struct Quotients {
    /// The products weight · (c₊ + c₋), stored in `re`, and weight · (c₋ − c₊), stored in `im`, as
    /// [pair, wave, n].
    values: ComplexRow,
    /// Frequencies at which [`Polygon::transform`] is used: index n along the row, shifted
    /// frequency, and weight.
    left: Vec<(usize, [f64; 2], Complex)>,
}

impl<'a> Corners<'a> {
    pub(crate) fn new(section: &'a AxisSection, waves: &'a [SectionWave]) -> Self {
        let mut pairs = Vec::new();
        let polygons = section.polygons.iter().enumerate();
        let corners: Vec<_> = polygons
            .flat_map(|(index, polygon)| prepared(polygon, index, &mut pairs))
            .collect();
        let phases = corners
            .iter()
            .flat_map(|corner| waves.iter().map(|w| w.phase(corner.at)))
            .collect();
        let edges = section.directions.iter().enumerate();
        let edges = edges
            .filter(|(d, _)| pairs.iter().any(|pair: &[usize; 2]| pair.contains(d)))
            .map(|(d, direction)| (d, CANCELLATION / longest(*direction)))
            .collect();
        Self {
            section,
            waves,
            corners,
            phases,
            pairs,
            edges,
        }
    }

    /// The windowed transforms of all polygons along a row, [polygon, n].
    pub(crate) fn row(&self, row: &FrequencyRow) -> Vec<Complex> {
        let count = row.count();
        let polygons = &self.section.polygons;
        let mut sums = ComplexRow::zeros(polygons.len() * count);
        let mut plain = vec![Complex::ZERO; polygons.len() * count];
        let waves = self.waves.len();
        for first in (0..waves).step_by(WAVES_AT_A_TIME) {
            let chunk = first..waves.min(first + WAVES_AT_A_TIME);
            let quotients = self.quotients(row, &self.waves[chunk.clone()]);
            self.add(row, &quotients, chunk, &mut sums);
            for &(n, k, weight) in &quotients.left {
                for (target, polygon) in plain[n..].iter_mut().step_by(count).zip(polygons) {
                    let transform = if self.section.has_discs {
                        polygon.transform_by_sides(k)
                    } else {
                        polygon.transform(k)
                    };
                    *target += transform * weight;
                }
            }
        }
        let scale = self.section.unit;
        let sums = sums.re.iter().zip(&sums.im);
        sums.zip(&plain)
            .map(|((&re, &im), &plain)| (Complex::new(re, im) + plain) * scale)
            .collect()
    }

    fn quotients(&self, row: &FrequencyRow, waves: &[SectionWave]) -> Quotients {
        let count = row.count();
        let mut quotients = Quotients {
            values: ComplexRow::zeros(self.pairs.len() * waves.len() * count),
            left: Vec::new(),
        };
        for (w, wave) in waves.iter().enumerate() {
            for shift in wave.shifts() {
                for n in 0..count {
                    let k = row.frequency(n);
                    let k = [k[0] + shift.frequency[0], k[1] + shift.frequency[1]];
                    if self.cancels(k) {
                        quotients.left.push((n, k, shift.weight));
                        continue;
                    }
                    for (pair, value) in self.pair_quotients(k).enumerate() {
                        let cell = (pair * waves.len() + w) * count + n;
                        quotients.values.re[cell] += shift.amplitude * value;
                        quotients.values.im[cell] -= shift.sign * shift.amplitude * value;
                    }
                }
            }
        }
        quotients
    }

    /// Checks whether the direction of any edge is nearly orthogonal to k.
    fn cancels(&self, k: [f64; 2]) -> bool {
        let directions = &self.section.directions;
        let mut edges = self.edges.iter();
        edges.any(|&(d, smallest)| dot(k, directions[d]).abs() < smallest)
    }

    /// Returns (d × e) / (4π² (k·d)(k·e)) for each pair (d, e) of different directions, and 1/(2π
    /// k·d) for each pair of equal directions.
    fn pair_quotients(&self, k: [f64; 2]) -> impl Iterator<Item = f64> {
        self.pairs.iter().map(move |pair| {
            let [d, e] = pair.map(|i| self.section.directions[i]);
            if pair[0] == pair[1] {
                return 1.0 / (TAU * dot(k, d));
            }
            cross(d, e) / (4.0 * PI * PI * dot(k, d) * dot(k, e))
        })
    }

    /// Adds the contributions of all corners for the waves of `chunk`.
    fn add(
        &self,
        row: &FrequencyRow,
        quotients: &Quotients,
        chunk: std::ops::Range<usize>,
        sums: &mut ComplexRow,
    ) {
        let count = row.count();
        let all = self.waves.len();
        let mut exponentials = ComplexRow::zeros(count);
        let mut inner = ComplexRow::zeros(count);
        for (corner, phases) in self.corners.iter().zip(self.phases.chunks_exact(all)) {
            row.exponentials(corner.at, corner.sign, &mut exponentials);
            inner.re.fill(0.0);
            inner.im.fill(0.0);
            let start = corner.pair * chunk.len() * count;
            let cells = start..start + chunk.len() * count;
            let re = quotients.values.re[cells.clone()].chunks_exact(count);
            let im = quotients.values.im[cells].chunks_exact(count);
            for ((re, im), &[cos, sin]) in re.zip(im).zip(&phases[chunk.clone()]) {
                add_scaled(&mut inner.re, re, cos);
                add_scaled(&mut inner.im, im, sin);
            }
            let start = corner.polygon * count;
            add_product(sums, start..start + count, &inner, &exponentials);
        }
    }
}

impl SectionWave {
    /// Returns (cos θ, sin θ) of the wave's phase at p, θ = 2π s·p + phase.
    fn phase(&self, p: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = libm::sincos(self.angle(p));
        [cos, sin]
    }
}

/// The length of the longest edge along a direction that fits into the square |p| < 1. The
/// length is in units of |direction|.
fn longest(direction: [f64; 2]) -> f64 {
    2.0 / direction[0].abs().max(direction[1].abs())
}

/// Prepares the corners of a polygon; new pairs of directions are added to `pairs`.
fn prepared(polygon: &Polygon, index: usize, pairs: &mut Vec<[usize; 2]>) -> Vec<Corner> {
    let corners = polygon.corners();
    if polygon.is_segment() {
        return ends(corners, index, pairs);
    }
    let before = corners.iter().cycle().skip(corners.len() - 1);
    let mut result = Vec::with_capacity(corners.len());
    for (corner, before) in corners.iter().zip(before) {
        let (enter, leave) = (before.edge, corner.edge);
        // Two consecutive collinear edges do not form a corner.
        if enter == leave {
            continue;
        }
        let sign = if enter < leave { 1.0 } else { -1.0 };
        result.push(Corner {
            at: corner.at,
            pair: listed([enter.min(leave), enter.max(leave)], pairs),
            sign: Complex::from(sign),
            polygon: index,
        });
    }
    result
}

/// Prepares the two ends a and b of a segment, whose transform is (exp(−2πi k·a) − exp(−2πi k·b))
/// / (2πi k·d).
fn ends(corners: &[polygon::Vertex], index: usize, pairs: &mut Vec<[usize; 2]>) -> Vec<Corner> {
    let signs = [-1.0, 1.0].into_iter();
    corners
        .iter()
        .zip(signs)
        .map(|(corner, sign)| Corner {
            at: corner.at,
            pair: listed([corner.edge; 2], pairs),
            sign: Complex::new(0.0, sign),
            polygon: index,
        })
        .collect()
}

/// Returns the index of a pair in the list `pairs`, and appends the pair if the list does not
/// contain it.
fn listed(pair: [usize; 2], pairs: &mut Vec<[usize; 2]>) -> usize {
    let known = pairs.iter().position(|p| *p == pair);
    known.unwrap_or_else(|| {
        pairs.push(pair);
        pairs.len() - 1
    })
}
