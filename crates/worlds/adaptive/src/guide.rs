//! Computes a guide for the reconstruction. The guide is the direct light at all visible points. It
//! is computed from one path per point, and its noise is smoothed.
//!
//! The guide shows where shadows and highlights end; sparse samples cannot show this. The
//! difference between the light and the guide is smoother than the light itself. Therefore planes
//! are fitted to this difference at the samples, and the guide is added afterwards. A guide is
//! noisy, and contains no indirect light. Therefore the errors of the first samples determine which
//! share of the guide is used for each object.

use crate::criterion::shaded;
use crate::cross::{CrossError, dark};
use crate::objects::ObjectSums;
use crate::reconstruct::{ShadedSample, bell, unlike};
use crate::shading::Shader;
use crate::smooth::{EdgeFilter, FilterPoints, PlaceValues, detailed};
use crate::visible::{FOUR, SeenPlace, SeenSurface, Visible, at, squared_distance};
use etendue_paths::View;
use rayon::prelude::*;

/// Width in pixels of a tile. The paths from the points of a tile share a net.
const TILE: usize = 4;

/// The filter of sharp shadows.
const SHARP: EdgeFilter = EdgeFilter {
    radius: 1,
    step: 1,
    width: 0.6,
};

/// The filter of soft shadows.
const SOFT: EdgeFilter = EdgeFilter {
    radius: 2,
    step: 1,
    width: 1.2,
};

/// The filter for places where light changes slowly. It is applied to the result of [`SOFT`].
const SLOW: EdgeFilter = EdgeFilter {
    radius: 2,
    step: 3,
    width: 1.2,
};

/// Direct light at all points of a picture, without texture factors.
#[derive(Debug)]
pub(crate) struct LightGuide {
    values: PlaceValues,
    shares: GuideShares,
}

/// The guide of a sample, for base and lobe.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SampleGuide {
    pub(crate) value: [f64; 2],
    variance: [f64; 2],
}

impl LightGuide {
    /// Smooths the noisy direct light `rough` of all points.
    pub(crate) fn new(visible: &Visible, rough: &[[f64; 2]]) -> Self {
        let points = FilterPoints::new(visible);
        let filtered = |filter: EdgeFilter, values: &[[f64; 2]]| filter.smoothed(&points, values);
        let soft = filtered(SOFT, rough);
        let slow = filtered(SLOW, &soft);
        let smooth = detailed(visible, &soft, &slow);
        let sharp = filtered(SHARP, rough);
        Self {
            values: detailed(visible, &sharp, &smooth),
            shares: GuideShares::default(),
        }
    }

    /// The whole guide at a sample.
    pub(crate) fn at(&self, visible: &Visible, sample: &ShadedSample) -> SampleGuide {
        let pixel = visible.pixel_at(sample.at);
        let near = |(i, index): (usize, usize)| {
            let seen = shaded(&visible.places[index])?;
            let square = squared_distance(sample.at, at(pixel, i));
            let weight = bell(square + unlike(&sample.surface, seen));
            (seen.shape == sample.surface.shape).then_some((weight, self.values[index]))
        };
        let near: Vec<(f64, [f64; 2])> =
            visible.range(pixel).enumerate().filter_map(near).collect();
        if near.is_empty() {
            return SampleGuide::default();
        }
        let count = near.len() as f64;
        let total: f64 = near.iter().map(|(weight, _)| weight).sum();
        let mean = |part: usize| near.iter().map(|(w, value)| w * value[part]).sum::<f64>() / total;
        let value = [0, 1].map(mean);
        let variance = |part: usize| {
            let squares = near.iter().map(|(_, of)| (of[part] - value[part]).powi(2));
            squares.sum::<f64>() / (count * (count - 1.0).max(1.0))
        };
        SampleGuide {
            value,
            variance: [0, 1].map(variance),
        }
    }

    /// Chooses the share of the guide for each object. Subtracts this share from the samples, and
    /// returns the errors of planes through the results. `plain` contains the errors of planes
    /// through unchanged samples, and `of_guide` contains the errors of planes through `guides`.
    pub(crate) fn trust(
        &mut self,
        samples: &[(ShadedSample, f64)],
        guides: &[SampleGuide],
        [plain, of_guide]: [&[CrossError]; 2],
    ) -> Vec<CrossError> {
        let dark = dark(samples);
        for (plain, of_guide) in plain.iter().zip(of_guide) {
            let (sample, _) = &samples[plain.index];
            let light = sample.surface.light(sample.value);
            let scale = light * light + dark * dark;
            let weights = sample.surface.factors.map(|factor| factor * factor / scale);
            let noise = guides[plain.index].variance;
            let products = [0, 1].map(|part: usize| {
                let [a, b] = [plain.off[part], of_guide.off[part]];
                [a * b, b * b, noise[part]].map(|product| weights[part] * product)
            });
            self.shares.add(sample.surface.shape, products);
        }
        let pairs = plain.iter().zip(of_guide);
        let left = pairs.map(|(plain, of_guide)| {
            let shares = self.shares.of(samples[plain.index].0.surface.shape);
            let off = [0, 1].map(|part: usize| plain.off[part] - shares[part] * of_guide.off[part]);
            CrossError { off, ..*plain }
        });
        left.collect()
    }

    /// The share of the guide that is used at a point of the picture.
    pub(crate) fn used(&self, index: usize, surface: &SeenSurface) -> [f64; 2] {
        let shares = self.shares.of(surface.shape);
        [0, 1].map(|part: usize| shares[part] * self.values[index][part])
    }

    /// Returns samples from which the used share of the guide is subtracted.
    pub(crate) fn without(&self, visible: &Visible, samples: &[ShadedSample]) -> Vec<ShadedSample> {
        let less = |sample: &ShadedSample| {
            let guide = self.at(visible, sample).value;
            let shares = self.shares.of(sample.surface.shape);
            let value = [0, 1].map(|part: usize| sample.value[part] - shares[part] * guide[part]);
            ShadedSample { value, ..*sample }
        };
        samples.par_iter().map(less).collect()
    }
}

/// Computes direct light by one path from the point with an index, in a picture of a width.
pub(crate) fn direct(
    shader: &Shader<'_>,
    width: usize,
    index: usize,
    view: &View,
    place: &SeenPlace,
) -> [f64; 2] {
    let of = || {
        let surface = shaded(place)?;
        let [column, row] = [index / FOUR % width, index / FOUR / width];
        let tile = (row / TILE) * width.div_ceil(TILE) + column / TILE;
        let point = morton([column % TILE, row % TILE]) * FOUR + index % FOUR;
        let of_net = (tile as u64, u32::try_from(point).ok()?);
        Some(shader.direct(view.surface.as_ref()?, surface.factors, of_net))
    };
    of().unwrap_or_default()
}

/// The number of a pixel in a tile, in the order of Morton 1966. In this order, the pixels
/// of each quarter of the tile have consecutive numbers, and so have the pixels of each quarter of
/// a quarter.
fn morton([column, row]: [usize; 2]) -> usize {
    (0..TILE.ilog2()).fold(0, |number, bit| {
        number | ((column >> bit) & 1) << (2 * bit) | ((row >> bit) & 1) << (2 * bit + 1)
    })
}

/// The squared error of planes through all samples, divided by the squared error of planes through
/// one half of the first samples. Unlike these errors, the noise of a guide does not decrease if
/// there are more samples.
const SMALLER: f64 = 1.0 / 6.0;

/// The shares of the guide that objects use, for base and lobe. The shares are computed from sums
/// of the product of both errors, the square of the guide's error, and the variance of the guide.
#[derive(Debug, Default)]
struct GuideShares([ObjectSums<3>; 2]);

impl GuideShares {
    fn add(&mut self, shape: usize, products: [[f64; 3]; 2]) {
        for (sums, products) in self.0.iter_mut().zip(products) {
            sums.add(shape, products);
        }
    }

    /// The shares s that minimise the error plain − s · guide of all samples, noise
    /// included.
    fn of(&self, shape: usize) -> [f64; 2] {
        self.0.each_ref().map(|sums| {
            let [both, square, noise] = sums.of(shape);
            let square = (square - noise).max(0.0) + noise / SMALLER;
            if square > 0.0 {
                (both / square).clamp(0.0, 1.0)
            } else {
                0.0
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If a guide has no noise and its errors equal the errors of the planes, the whole guide is
    /// used. If its errors differ, or if its noise is large, the guide is not used.
    #[test]
    fn shares_follow_errors() {
        let mut shares = GuideShares::default();
        for i in 0..1000 {
            let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
            shares.add(0, [[1.0, 1.0, 0.0]; 2]);
            shares.add(1, [[sign, 1.0, 0.0]; 2]);
            shares.add(2, [[1.0, 2.0, 1.0]; 2]);
        }
        let [useful, other, noisy] = [0, 1, 2].map(|shape| shares.of(shape)[0]);
        assert!(useful > 0.98, "{useful}"); // shared samples
        assert!(other < 0.02, "{other}"); // shared samples
        assert!((noisy - 1.0 / 7.0).abs() < 0.01, "{noisy}"); // shared samples
    }

    #[test]
    fn quarters_of_a_tile_have_consecutive_numbers() {
        let quarter = [[2, 0], [3, 0], [2, 1], [3, 1]].map(morton);
        assert_eq!(quarter, [4, 5, 6, 7]);
    }
}
