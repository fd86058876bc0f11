//! Generates blue noise with a given density. Blue noise consists of random points that are not
//! close to each other (Yuksel 2015, *Sample Elimination for Generating Poisson Disk Sample Sets*).
//!
//! More candidates than needed are drawn from the density. Again and again, the candidate with the
//! most crowded neighbourhood is removed, until the required number is left. Distances are measured
//! in the metric for which the density is 1 everywhere.

use crate::metric::Metric;
use etendue_field::whole;
use etendue_sampling::DiscreteDistribution;
use etendue_transform::random::{Stream, unit, words};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Number of candidates for each point that is kept.
const CANDIDATES: usize = 5;

/// The eighth power, which Eq. 3 of Yuksel 2015 uses.
fn eighth(x: f64) -> f64 {
    let square = x * x;
    let fourth = square * square;
    fourth * fourth
}

/// A point of the picture, in pixels to the right and down from its top left.
pub(crate) type PixelPosition = [f64; 2];

#[derive(Clone, Copy, Debug)]
pub(crate) struct PicturePoint {
    pub(crate) at: PixelPosition,
    pub(crate) metric: Metric,
}

/// Returns at most `count` points over a picture `wide` pixels across, in order of pixels.
pub(crate) fn blue_noise(
    metrics: &[Option<Metric>],
    wide: usize,
    count: usize,
    seed: u64,
) -> Vec<PicturePoint> {
    let candidates = candidates(metrics, wide, count, seed);
    let mut is_kept = vec![true; candidates.len()];
    let mut crowd = Crowd::new(&candidates, wide, metrics.len() / wide.max(1));
    let mut left = candidates.len();
    while left > count
        && let Some(out) = crowd.most_crowded(&is_kept)
    {
        is_kept[out] = false;
        crowd.leave(out);
        left -= 1;
    }
    let kept = candidates.into_iter().zip(is_kept);
    kept.filter_map(|(point, is_kept)| is_kept.then_some(point))
        .collect()
}

/// Random points that are drawn from the density. The points are drawn independently.
/// Stratified points would be less crowded in dense regions, so elimination would leave too many
/// points in these regions.
fn candidates(
    metrics: &[Option<Metric>],
    wide: usize,
    count: usize,
    seed: u64,
) -> Vec<PicturePoint> {
    let density = |metric: &Metric| metric.determinant().max(0.0).sqrt();
    let densities = metrics.iter().map(|m| m.as_ref().map_or(0.0, density));
    let pixels = DiscreteDistribution::new(densities);
    if pixels.total() <= 0.0 {
        return Vec::new();
    }
    let draw = |i: usize| {
        let [at, x, y, _] = words(seed, Stream::Jitter, i as u64, 0).map(unit);
        let pixel = pixels.sample(at);
        let metric = metrics[pixel]?;
        Some(PicturePoint {
            at: [(pixel % wide) as f64 + x, (pixel / wide) as f64 + y],
            metric,
        })
    };
    (0..CANDIDATES * count).filter_map(draw).collect()
}

/// The weights of the candidates, which measure crowding.
#[derive(Debug)]
struct Crowd {
    /// The neighbours of each candidate, with their contributions to its weight.
    neighbours: Vec<Vec<(u32, f64)>>,
    weights: Vec<f64>,
    /// The candidates with the ranks of their weights, which may be outdated because weights
    /// decrease. Of equal weights, the lowest index is first.
    queue: BinaryHeap<(i64, Reverse<u32>)>,
}

/// A number by which weights are ordered, as by [`f64::total_cmp`].
fn rank(weight: f64) -> i64 {
    let bits = weight.to_bits().cast_signed();
    bits ^ ((bits >> 63).cast_unsigned() >> 1).cast_signed()
}

/// The maximum radius of discs of density 1 (Yuksel 2015, Eq. 1).
fn largest_radius() -> f64 {
    (2.0 * 3.0_f64.sqrt()).recip().sqrt()
}

impl Crowd {
    fn new(points: &[PicturePoint], wide: usize, high: usize) -> Self {
        let most = 2.0 * largest_radius();
        // This minimum distance limits the weight of two candidates that are close by chance in a
        // region that is not crowded (Yuksel 2015, Eq. 4).
        let kept = (CANDIDATES as f64).recip();
        let least = most * (1.0 - kept * kept.sqrt()) * 0.65;
        let grid = PointGrid::new(points, wide, high);
        let of = |i: usize| {
            let point = &points[i];
            let mut found = Vec::new();
            grid.near(point, 2.0 * most, |j| {
                let other = &points[j as usize];
                if j as usize == i {
                    return;
                }
                let step = [0, 1].map(|k: usize| other.at[k] - point.at[k]);
                let square = 0.5 * (point.metric.square(step) + other.metric.square(step));
                let distance = square.sqrt().max(least);
                if distance < most {
                    found.push((j, eighth(1.0 - distance / most)));
                }
            });
            found
        };
        let neighbours: Vec<Vec<(u32, f64)>> = (0..points.len()).map(of).collect();
        let weights: Vec<f64> = neighbours
            .iter()
            .map(|near| near.iter().map(|(_, weight)| weight).sum())
            .collect();
        let entries = weights.iter().zip(0..);
        let entries = entries.map(|(weight, index)| (rank(*weight), Reverse(index)));
        Self {
            queue: entries.collect(),
            neighbours,
            weights,
        }
    }

    fn most_crowded(&mut self, is_kept: &[bool]) -> Option<usize> {
        loop {
            let (before, index) = self.queue.pop()?;
            let out = index.0 as usize;
            if !is_kept[out] {
                continue;
            }
            let now = rank(self.weights[out]);
            if now >= before {
                return Some(out);
            }
            self.queue.push((now, index));
        }
    }

    fn leave(&mut self, out: usize) {
        for (neighbour, weight) in std::mem::take(&mut self.neighbours[out]) {
            self.weights[neighbour as usize] -= weight;
        }
    }
}

/// A grid that sorts the points into squares of the picture.
#[derive(Debug)]
struct PointGrid {
    cells: Vec<Vec<u32>>,
    size: [usize; 2],
}

/// Width of a square in pixels.
const CELL: usize = 3;

impl PointGrid {
    fn new(points: &[PicturePoint], wide: usize, high: usize) -> Self {
        let size = [wide, high].map(|n| n / CELL + 1);
        let mut cells = vec![Vec::new(); size[0] * size[1]];
        for (point, index) in points.iter().zip(0..) {
            let [x, y] = [0, 1].map(|k: usize| cell(point.at[k], size[k]));
            cells[y * size[0] + x].push(index);
        }
        Self { cells, size }
    }

    /// Visits the points of all squares within a distance of a point.
    fn near(&self, point: &PicturePoint, radius: f64, mut found: impl FnMut(u32)) {
        let reach = point.metric.reach(radius);
        let [columns, rows] = [0, 1].map(|k: usize| {
            let at = |side: f64| cell(point.at[k] + side * reach[k], self.size[k]);
            at(-1.0)..=at(1.0)
        });
        for row in rows {
            for column in columns.clone() {
                self.cells[row * self.size[0] + column]
                    .iter()
                    .for_each(|index| found(*index));
            }
        }
    }
}

/// The number of a cell, clamped to the grid.
fn cell(at: f64, cells: usize) -> usize {
    whole(at / CELL as f64).min(cells - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nearest(points: &[PicturePoint], i: usize) -> f64 {
        let others = points.iter().enumerate().filter(|(j, _)| *j != i);
        let squares = others.map(|(_, other)| {
            let step = [0, 1].map(|k: usize| other.at[k] - points[i].at[k]);
            points[i].metric.square(step)
        });
        squares.fold(f64::INFINITY, f64::min).sqrt()
    }

    /// The smallest distance between random points is almost 0. The smallest distance between
    /// Yuksel's points is about three quarters of the maximum (0.73 to 0.82 in his Table 1).
    #[test]
    fn points_keep_their_distance() {
        let even = vec![Some(Metric::even(0.05)); 100 * 80];
        let points = blue_noise(&even, 100, 400, 3);
        assert_eq!(points.len(), 400);
        let inside = |at: PixelPosition| at[0] > 5.0 && at[0] < 95.0 && at[1] > 5.0 && at[1] < 75.0;
        let all = (0..points.len()).filter(|i| inside(points[*i].at));
        let closest = all
            .map(|i| nearest(&points, i))
            .fold(f64::INFINITY, f64::min);
        // Random points of the same number have a minimum distance of about 0.03.
        assert!(closest > 0.6 * 2.0 * largest_radius(), "{closest}");
    }

    #[test]
    fn density_is_followed() {
        let metrics: Vec<Option<Metric>> = (0..120 * 100)
            .map(|i| Some(Metric::even(if i % 120 < 60 { 0.02 } else { 0.18 })))
            .collect();
        let points = blue_noise(&metrics, 120, 1200, 5);
        let left = points.iter().filter(|point| point.at[0] < 60.0).count();
        // The expected number of points is 0.02 · 6000; elimination moves some points across the
        // edge.
        assert!((left as f64 - 120.0).abs() < 12.0, "{left}");
    }

    /// At frequencies below the inverse distance of neighbours, blue noise has almost no power,
    /// while the power of random points is 1.
    #[test]
    fn low_frequencies_are_quiet() {
        let even = vec![Some(Metric::even(0.1)); 100 * 100];
        let points = blue_noise(&even, 100, 1000, 7);
        let power = |frequency: [f64; 2]| {
            // A window suppresses the edge of the picture.
            let hann = |x: f64| 1.0 - libm::cos(std::f64::consts::TAU * x / 100.0);
            let [mut re, mut im, mut all] = [0.0; 3];
            for PicturePoint { at, .. } in &points {
                let weight = hann(at[0]) * hann(at[1]);
                let phase = std::f64::consts::TAU * (frequency[0] * at[0] + frequency[1] * at[1]);
                let (sin, cos) = libm::sincos(phase);
                re += weight * cos;
                im += weight * sin;
                all += weight * weight;
            }
            (re * re + im * im) / all
        };
        let ring = |radius: f64| {
            let at = |i: i32| {
                let (sin, cos) = libm::sincos(0.1 + f64::from(i) * std::f64::consts::PI / 24.0);
                power([radius * cos, radius * sin])
            };
            (0..24).map(at).sum::<f64>() / 24.0
        };
        // In a triangular lattice neighbours would be 3.4 pixels apart, and rows would repeat 0.34
        // times per pixel.
        let [low, peak] = [ring(0.1), ring(0.34)];
        assert!(low < 0.15 && peak > 1.5, "{low} {peak}");
    }
}
