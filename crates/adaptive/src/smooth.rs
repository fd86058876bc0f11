//! Smooths noisy values at all visible points of a picture.

use crate::criterion::shaded;
use crate::reconstruct::{LightMean, bell, unlike};
use crate::visible::{FOUR, Visible};
use rayon::prelude::*;
use std::ops::Range;

/// Values of base and lobe at all points.
pub(crate) type PlaceValues = Vec<[f64; 2]>;

/// A filter whose weights fall with distance, and across edges.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EdgeFilter {
    /// Number of neighbours to each side.
    pub(crate) radius: usize,
    /// Pixels from one neighbour to the next.
    pub(crate) step: usize,
    /// Standard deviation, in steps.
    pub(crate) width: f64,
}

impl EdgeFilter {
    /// Smooths values. A point of a pixel uses only the points with the same number in other
    /// pixels, so the errors of the points of a pixel are independent.
    pub(crate) fn smoothed(&self, visible: &Visible, values: &[[f64; 2]]) -> PlaceValues {
        let variance = (self.width * self.step as f64).powi(2);
        let of = |index: usize| {
            let surface = shaded(&visible.places[index])?;
            let pixel = visible.pixel(index);
            let [columns, rows] = [0, 1].map(|k: usize| self.near(pixel[k], visible.size[k]));
            let mut mean = LightMean::default();
            for row in rows {
                for column in columns.clone() {
                    let other = visible.range([column, row]).start + index % FOUR;
                    let Some(seen) = shaded(&visible.places[other]) else {
                        continue;
                    };
                    if seen.shape == surface.shape {
                        let off = [pixel[0].abs_diff(column), pixel[1].abs_diff(row)];
                        let near = (off[0] * off[0] + off[1] * off[1]) as f64 / variance;
                        mean.add(bell(near + unlike(surface, seen)), values[other]);
                    }
                }
            }
            mean.mean()
        };
        let all = (0..visible.places.len()).into_par_iter();
        all.map(|index| of(index).unwrap_or_default()).collect()
    }

    /// Returns the coordinates of neighbours within the picture.
    fn near(&self, at: usize, size: usize) -> std::iter::StepBy<Range<usize>> {
        let far = self.radius * self.step;
        let first = if at >= far { at - far } else { at % self.step };
        (first..(at + far + 1).min(size)).step_by(self.step)
    }
}

/// Pixels to each side over which the power of details and their noise are averaged.
const AROUND: usize = 2;

/// The detail is the difference between sharper and smooth values. Adds the share 1 − noise/square
/// of the detail to the smooth values. The noise is estimated from the differences between the
/// points of a pixel.
pub(crate) fn detailed(visible: &Visible, sharp: &[[f64; 2]], smooth: &[[f64; 2]]) -> PlaceValues {
    let powers = visible.pixels(|pixel| {
        let places = visible.range(pixel);
        let places = places.filter(|i| shaded(&visible.places[*i]).is_some());
        let places: Vec<usize> = places.collect();
        [0, 1].map(|part: usize| {
            let details = places.iter().map(|i| sharp[*i][part] - smooth[*i][part]);
            power(&details.collect::<Vec<_>>())
        })
    });
    let shares = visible.pixels(|pixel| {
        let mut sums = [DetailPower::default(); 2];
        for [column, row] in visible.around(pixel, AROUND) {
            for (sum, power) in sums.iter_mut().zip(powers[row * visible.size[0] + column]) {
                sum.noise += power.noise;
                sum.square += power.square;
            }
        }
        sums.map(DetailPower::share)
    });
    let of = |i: usize| {
        [0, 1].map(|part: usize| {
            let [low, high] = [smooth[i][part], sharp[i][part]];
            low + shares[i / FOUR][part] * (high - low)
        })
    };
    (0..sharp.len()).into_par_iter().map(of).collect()
}

/// The square of the mean detail of a pixel, and the variance of this mean.
#[derive(Clone, Copy, Debug, Default)]
struct DetailPower {
    noise: f64,
    square: f64,
}

impl DetailPower {
    /// Returns the share of the detail that is kept. The variance is doubled for caution, because
    /// it is estimated from few points.
    fn share(self) -> f64 {
        if self.square > 0.0 {
            (1.0 - 2.0 * self.noise / self.square).max(0.0)
        } else {
            0.0
        }
    }
}

fn power(details: &[f64]) -> DetailPower {
    let count = details.len() as f64;
    if count < 2.0 {
        return DetailPower::default();
    }
    let mean = details.iter().sum::<f64>() / count;
    let spread: f64 = details.iter().map(|d| (d - mean).powi(2)).sum();
    DetailPower {
        noise: spread / (count * (count - 1.0)),
        square: mean * mean,
    }
}
