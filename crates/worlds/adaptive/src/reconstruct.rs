//! Reconstructs the picture between samples. At each point, a plane is fitted to the samples around
//! the point, weighted by similarity in shape, normal and position. The weights form a bilateral
//! filter (Tomasi and Manduchi 1998). The width of the filter follows the metric of the samples, as
//! in Durand et al. 2005, section 6.2.

use crate::blue_noise::PixelPosition;
use crate::criterion::shaded;
use crate::metric::Metric;
use crate::visible::{FOUR, SeenSurface, Visible, at};
use etendue_field::whole;
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

/// A shaded point of the picture, with its value.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShadedSample {
    pub(crate) at: PixelPosition,
    pub(crate) metric: Metric,
    pub(crate) surface: SeenSurface,
    /// The values of the base and of the lobe, without texture factors.
    pub(crate) value: [f64; 2],
}

/// Standard deviation of the filter, in units in which neighbours are about 1 apart. With a
/// narrower filter, some points would use only one sample. A wider filter would blur details that
/// the samples show.
const WIDTH: f64 = 0.5;

/// Distances at which the filter ends, in standard deviations. The first round uses the first
/// distance. Later rounds use the other distances, at points that no sample has reached.
const REACHES: [f64; 3] = [3.0, 9.0, 27.0];

/// Standard deviation of the filter over normals. This value separates faces that meet at a right
/// angle, but not neighbouring samples on a curved surface.
const NORMALS: f64 = 0.35;

/// Standard deviation of the filter over elevation angles. A sample has an elevation angle above
/// the surface at a point.
const HEIGHTS: f64 = 0.2;

/// Pixel rows per band, the unit of work of a thread.
const BAND: usize = 8;

/// The method of reconstruction from samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SampleFit {
    /// The mean of the samples.
    Mean,
    /// A plane through the samples.
    Plane,
}

/// The values at all points, or `None` if nothing is shaded or no sample is near.
pub(crate) fn reconstruct(
    visible: &Visible,
    samples: &[ShadedSample],
    fit: SampleFit,
) -> Vec<Option<[f64; 2]>> {
    reconstruct_where(visible, samples, fit, &|_| true)
}

/// Reconstructs values like [`reconstruct()`], but only at points whose index is wanted.
pub(crate) fn reconstruct_where(
    visible: &Visible,
    samples: &[ShadedSample],
    fit: SampleFit,
    is_wanted: &(dyn Fn(usize) -> bool + Sync),
) -> Vec<Option<[f64; 2]>> {
    let bands = visible.size[1].div_ceil(BAND);
    let of = |band: usize| Band::new(visible, band).filled(samples, fit, is_wanted);
    (0..bands).into_par_iter().flat_map_iter(of).collect()
}

/// Reconstructs values like [`reconstruct()`], but only at the first shaded point of each pixel.
pub(crate) fn reconstruct_pixels(
    visible: &Visible,
    samples: &[ShadedSample],
    fit: SampleFit,
) -> Vec<Option<[f64; 2]>> {
    let first = visible.pixels(|pixel| {
        let mut points = visible.range(pixel);
        points.find(|i| shaded(&visible.places[*i]).is_some())
    });
    let is_first = |i: usize| first[i / FOUR] == Some(i);
    let values = reconstruct_where(visible, samples, fit, &is_first);
    first.iter().map(|i| values[(*i)?]).collect()
}

/// Sums over samples at one point. The positions of samples are relative to the point, in units of
/// the metric.
#[derive(Clone, Copy, Debug)]
struct LocalSums {
    weight: f64,
    x: [f64; 2],
    xx: [f64; 3],
    values: [ValueSums; 2],
}

/// The sums for one value.
#[derive(Clone, Copy, Debug)]
struct ValueSums {
    value: f64,
    xv: [f64; 2],
    range: [f64; 2],
}

impl LocalSums {
    const ZERO: Self = Self {
        weight: 0.0,
        x: [0.0; 2],
        xx: [0.0; 3],
        values: [ValueSums {
            value: 0.0,
            xv: [0.0; 2],
            range: [f64::INFINITY, f64::NEG_INFINITY],
        }; 2],
    };

    fn add(&mut self, weight: f64, [x, y]: [f64; 2], values: [f64; 2]) {
        self.weight += weight;
        self.x = [self.x[0] + weight * x, self.x[1] + weight * y];
        self.xx = [
            self.xx[0] + weight * x * x,
            self.xx[1] + weight * x * y,
            self.xx[2] + weight * y * y,
        ];
        for (of, value) in self.values.iter_mut().zip(values) {
            of.value += weight * value;
            of.xv = [of.xv[0] + weight * x * value, of.xv[1] + weight * y * value];
            of.range = [of.range[0].min(value), of.range[1].max(value)];
        }
    }

    fn values(&self, fit: SampleFit) -> Option<[f64; 2]> {
        (self.weight > 0.0).then(|| match fit {
            SampleFit::Mean => self.values.map(|of| of.value / self.weight),
            SampleFit::Plane => self.values.map(|of| self.plane(&of)),
        })
    }

    /// The value of the fitted plane at the point.
    fn plane(&self, of: &ValueSums) -> f64 {
        // Positions are relative to their mean. The added term keeps the slope small if there are
        // few samples.
        let [x, y] = self.x.map(|x| x / self.weight);
        let mean = of.value / self.weight;
        let ridge = 0.1 * WIDTH * WIDTH;
        let xx = self.xx[0] / self.weight - x * x + ridge;
        let xy = self.xx[1] / self.weight - x * y;
        let yy = self.xx[2] / self.weight - y * y + ridge;
        let [xv, yv] = [0, 1].map(|i: usize| of.xv[i] / self.weight - [x, y][i] * mean);
        let determinant = xx * yy - xy * xy;
        let slope = [yy * xv - xy * yv, xx * yv - xy * xv].map(|s| s / determinant);
        let found = mean - slope[0] * x - slope[1] * y;
        found.clamp(of.range[0], of.range[1])
    }
}

struct Band<'a> {
    visible: &'a Visible,
    first_row: usize,
    rows: usize,
    sums: Vec<LocalSums>,
}

impl<'a> Band<'a> {
    fn new(visible: &'a Visible, band: usize) -> Self {
        let first_row = band * BAND;
        let rows = BAND.min(visible.size[1] - first_row);
        Self {
            visible,
            first_row,
            rows,
            sums: vec![LocalSums::ZERO; FOUR * rows * visible.size[0]],
        }
    }

    fn filled(
        mut self,
        samples: &[ShadedSample],
        fit: SampleFit,
        is_wanted: &(dyn Fn(usize) -> bool + Sync),
    ) -> Vec<Option<[f64; 2]>> {
        let first = self.visible.range([0, self.first_row]).start;
        let places = &self.visible.places[first..][..self.sums.len()];
        for reach in REACHES {
            let is_empty = |sums: &LocalSums| sums.weight <= 0.0;
            let missing: Vec<bool> = places
                .iter()
                .zip(&self.sums)
                .enumerate()
                .map(|(i, (place, sums))| {
                    shaded(place).is_some() && is_empty(sums) && is_wanted(first + i)
                })
                .collect();
            if !missing.contains(&true) {
                break;
            }
            for sample in samples {
                self.splat(sample, reach * WIDTH, &missing);
            }
        }
        self.sums.iter().map(|sums| sums.values(fit)).collect()
    }

    /// Adds a sample to all points within its reach.
    fn splat(&mut self, sample: &ShadedSample, radius: f64, missing: &[bool]) {
        let size = self.visible.size;
        let reach = sample.metric.reach(radius);
        let [columns, rows] = [0, 1].map(|k: usize| {
            let ends = [-1.0, 1.0].map(|side| sample.at[k] + side * reach[k]);
            pixels(ends, size[k])
        });
        let rows = rows.start.max(self.first_row)..rows.end.min(self.first_row + self.rows);
        let unit = sample.metric.determinant().sqrt().sqrt();
        let first = self.visible.range([0, self.first_row]).start;
        for row in rows {
            let pixels = columns.clone().map(|column| [column, row]);
            for (pixel, i) in pixels.flat_map(|pixel| (0..FOUR).map(move |i| (pixel, i))) {
                let index = self.visible.range(pixel).start + i;
                if !missing[index - first] {
                    continue;
                }
                let place = at(pixel, i);
                let step = [0, 1].map(|k: usize| sample.at[k] - place[k]);
                let square = sample.metric.square(step);
                if square < radius * radius
                    && let Some(surface) = shaded(&self.visible.places[index])
                    && surface.shape == sample.surface.shape
                {
                    let near = square / (WIDTH * WIDTH);
                    let weight = libm::exp(-0.5 * (near + unlike(surface, &sample.surface)));
                    let step = step.map(|s| unit * s);
                    self.sums[index - first].add(weight, step, sample.value);
                }
            }
        }
    }
}

/// A bell-shaped weight at a squared distance, in squared standard deviations. The weight
/// is close to exp(−square/2) up to 2 standard deviations, and faster to compute.
#[inline(always)]
pub(crate) fn bell(square: f64) -> f64 {
    let root = 1.0 + square / 16.0;
    let fourth = (root * root) * (root * root);
    1.0 / (fourth * fourth)
}

/// How much two points of a shape differ in normal and elevation, in squared standard
/// deviations.
pub(crate) fn unlike(place: &SeenSurface, sample: &SeenSurface) -> f64 {
    let [place, sample] = [place, sample].map(|seen| [seen.normal, seen.position]);
    unlike_points(place, sample)
}

/// Like [`unlike()`], for points with a normal and a position.
#[inline(always)]
pub(crate) fn unlike_points(place: [DVec3; 2], sample: [DVec3; 2]) -> f64 {
    let [turned, between] = [0, 1].map(|k: usize| sample[k] - place[k]);
    let height = between.dot(place[0]);
    // From a point of a sphere to another, the normal turns by twice the elevation angle between
    // them. A larger elevation angle shows that the points are on different parts of the shape.
    // Two points at one position have a height of 0, and the least length keeps the quotient 0.
    let length = between.length_squared().max(f64::MIN_POSITIVE);
    turned.length_squared() / (NORMALS * NORMALS) + height * height / (length * (HEIGHTS * HEIGHTS))
}

/// Pixels that overlap an interval, clamped to the picture.
fn pixels([low, high]: [f64; 2], count: usize) -> Range<usize> {
    whole(low).min(count)..whole(high.floor() + 1.0).min(count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::visible::SeenPlace;

    fn surface([x, y]: PixelPosition) -> SeenSurface {
        SeenSurface {
            shape: 0,
            position: DVec3::new(x, y, 0.0),
            normal: DVec3::Z,
            axis: DVec3::Z,
            cutoff: 1.0,
            factors: [1.0, 0.0],
        }
    }

    /// Two samples 24 pixels apart have the values 0 and 1. Between them, Gaussian weights of
    /// standard deviation σ have the mean 1/(1 + exp(−24 x/σ²)) at a distance x from the middle. A
    /// prediction of twice the bandwidth halves σ.
    #[test]
    fn the_width_of_the_filter_follows_the_prediction() {
        let size = [64, 8];
        let place = |i: usize| SeenPlace {
            emitted: 0.0,
            surface: Some(surface(at([i / FOUR % 64, i / FOUR / 64], i % FOUR))),
        };
        let visible = Visible {
            size,
            places: (0..FOUR * 64 * 8).map(place).collect(),
        };
        for bandwidth in [1.0 / 24.0, 2.0 / 24.0] {
            let sample = |value: f64| ShadedSample {
                at: [20.0 + 24.0 * value, 4.0],
                metric: Metric::even(bandwidth * bandwidth),
                surface: surface([20.0 + 24.0 * value, 4.0]),
                value: [value, 0.0],
            };
            let samples = [sample(0.0), sample(1.0)];
            let values = reconstruct(&visible, &samples, SampleFit::Mean);
            let sigma = WIDTH / bandwidth;
            for column in 29..35 {
                let index = visible.range([column, 4]).start;
                let off = at([column, 4], 0)[0] - 32.0;
                let expected = (1.0 + (-24.0 * off / (sigma * sigma)).exp()).recip();
                let [found, _] = values[index].unwrap();
                assert!((found - expected).abs() < 1e-12, "{found} {expected}"); // rounding
            }
        }
    }
}
