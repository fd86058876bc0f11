//! Smooths noisy values at all visible points of a picture.

use crate::criterion::shaded;
use crate::reconstruct::{bell, unlike_points};
use crate::visible::{FOUR, Visible};
use fearless_simd::{Level, dispatch};
use glam::DVec3;
use rayon::prelude::*;

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
    pub(crate) fn smoothed(&self, points: &FilterPoints, values: &[[f64; 2]]) -> PlaceValues {
        let of_point = |i: usize| {
            let values = || values.iter().skip(i).step_by(FOUR);
            [0, 1].map(|part: usize| values().map(|value| value[part]).collect())
        };
        let values: [[Vec<f64>; 2]; FOUR] = std::array::from_fn(of_point);
        let (level, size @ [width, height]) = (points.level, points.size);
        let row = |row: usize| {
            let of = |i: usize| {
                let (points, values) = (&points.columns[i], &values[i]);
                dispatch!(level, _simd => self.row(points, values, size, row))
            };
            let found: [Vec<[f64; 2]>; FOUR] = std::array::from_fn(of);
            (0..FOUR * width).map(move |k| found[k % FOUR][k / FOUR])
        };
        (0..height).into_par_iter().flat_map_iter(row).collect()
    }

    /// Smooths the values of one point of each pixel of a row.
    #[inline(always)]
    fn row(
        &self,
        points: &Columns,
        values: &[Vec<f64>; 2],
        [width, height]: [usize; 2],
        row: usize,
    ) -> Vec<[f64; 2]> {
        let variance = (self.width * self.step as f64).powi(2);
        let far = self.radius * self.step;
        let mut sums = [(); 3].map(|()| vec![0.0; width]);
        let rows = row.saturating_sub(far)..(row + far + 1).min(height);
        for other in rows.filter(|other| row.abs_diff(*other).is_multiple_of(self.step)) {
            for column in (0..=2 * far).step_by(self.step) {
                // The neighbours are `column` − `far` columns to the right.
                let [left, right] = [far.saturating_sub(column), column.saturating_sub(far)];
                let Some(count) = width.checked_sub(left + right) else {
                    continue;
                };
                let off = [row.abs_diff(other), left + right];
                let near = (off[0] * off[0] + off[1] * off[1]) as f64 / variance;
                let [here, there] = [row * width + left, other * width + right];
                let values = values.each_ref().map(|of| &of[there..][..count]);
                let sums = sums.each_mut().map(|of| &mut of[left..][..count]);
                let pair = [here, there].map(|first| points.from(first, count));
                add(near, &pair, values, sums);
            }
        }
        let mean = |k: usize| {
            let mean = [1, 2].map(|part: usize| sums[part][k] / sums[0][k]);
            let is_shaded = points.shape[row * width + k] != NOT_SHADED;
            if is_shaded { mean } else { [0.0; 2] }
        };
        (0..width).map(mean).collect()
    }
}

/// Adds neighbours to the sums of weights and of weighted values of base and lobe. `near` is the
/// squared distance in the picture, in squared standard deviations.
#[inline(always)]
fn add(
    near: f64,
    [here, there]: &[Columns<&[usize], &[f64]>; 2],
    [base, lobe]: [&[f64]; 2],
    [weights, bases, lobes]: [&mut [f64]; 3],
) {
    for k in 0..weights.len() {
        let unlike = unlike_points(here.point(k), there.point(k));
        let is_same = here.shape[k] == there.shape[k];
        let weight = if is_same { bell(near + unlike) } else { 0.0 };
        weights[k] += weight;
        bases[k] += weight * base[k];
        lobes[k] += weight * lobe[k];
    }
}

/// The number of a shape where nothing is shaded.
const NOT_SHADED: usize = usize::MAX;

/// One visible point of each pixel, as columns of numbers, pixels in rows from the top. A processor
/// compares columns faster than structs.
#[derive(Debug, Default)]
struct Columns<I = Vec<usize>, F = Vec<f64>> {
    shape: I,
    normal: [F; 3],
    position: [F; 3],
}

impl Columns {
    /// Collects point `i` of each pixel.
    fn new(visible: &Visible, i: usize) -> Self {
        let mut columns = Self::default();
        for place in visible.places.iter().skip(i).step_by(FOUR) {
            let surface = shaded(place);
            let [normal, position] =
                surface.map_or([DVec3::ZERO; 2], |at| [at.normal, at.position]);
            columns
                .shape
                .push(surface.map_or(NOT_SHADED, |at| at.shape));
            for k in 0..3 {
                columns.normal[k].push(normal[k]);
                columns.position[k].push(position[k]);
            }
        }
        columns
    }

    /// Returns `count` points, starting at `first`.
    #[inline(always)]
    fn from(&self, first: usize, count: usize) -> Columns<&[usize], &[f64]> {
        Columns {
            shape: &self.shape[first..][..count],
            normal: self.normal.each_ref().map(|of| &of[first..][..count]),
            position: self.position.each_ref().map(|of| &of[first..][..count]),
        }
    }
}

impl Columns<&[usize], &[f64]> {
    /// Returns normal and position of a point.
    #[inline(always)]
    fn point(&self, k: usize) -> [DVec3; 2] {
        [self.normal, self.position].map(|of| DVec3::new(of[0][k], of[1][k], of[2][k]))
    }
}

/// The visible points of a picture, prepared for filters.
#[derive(Debug)]
pub(crate) struct FilterPoints {
    size: [usize; 2],
    level: Level,
    /// The columns of each of the four points of a pixel.
    columns: Vec<Columns>,
}

impl FilterPoints {
    pub(crate) fn new(visible: &Visible) -> Self {
        Self {
            size: visible.size,
            level: Level::new(),
            columns: (0..FOUR)
                .into_par_iter()
                .map(|i| Columns::new(visible, i))
                .collect(),
        }
    }
}

/// Pixels to each side over which the power of details and their noise are averaged.
const AROUND: usize = 2;

/// The detail is the difference between sharper and smooth values. Adds the share 1 − noise/square
/// of the detail to the smooth values. The noise is estimated from the differences between the
/// points of a pixel.
pub(crate) fn detailed(visible: &Visible, sharp: &[[f64; 2]], smooth: &[[f64; 2]]) -> PlaceValues {
    let powers = visible.pixels(|pixel| {
        let points = visible.range(pixel);
        let points = points.filter(|i| shaded(&visible.places[*i]).is_some());
        let details = points.map(|i| [0, 1].map(|part: usize| sharp[i][part] - smooth[i][part]));
        [0, 1].map(|part: usize| power(details.clone().map(|detail| detail[part])))
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
    /// The share of the detail that is kept. The variance is doubled for caution, because
    /// it is estimated from few points.
    fn share(self) -> f64 {
        if self.square > 0.0 {
            (1.0 - 2.0 * self.noise / self.square).max(0.0)
        } else {
            0.0
        }
    }
}

fn power(details: impl Iterator<Item = f64> + Clone) -> DetailPower {
    let count = details.clone().count() as f64;
    if count < 2.0 {
        return DetailPower::default();
    }
    let mean = details.clone().sum::<f64>() / count;
    let spread: f64 = details.map(|detail| (detail - mean).powi(2)).sum();
    DetailPower {
        noise: spread / (count * (count - 1.0)),
        square: mean * mean,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_transform::random::{Stream, unit, words};

    const SIZE: [usize; 2] = [11, 7];

    /// Random points of three shapes, a quarter of them not shaded.
    fn points() -> Columns {
        let number = |i: usize, k: u32| unit(words(1, Stream::Backward, i as u64, k)[0]);
        let count = SIZE[0] * SIZE[1];
        let numbers = |k: u32| (0..count).map(|i| number(i, k)).collect();
        let shape = |i: usize| match number(i, 6) {
            x if x < 0.25 => NOT_SHADED,
            x => usize::from(x < 0.5) + usize::from(x < 0.75),
        };
        Columns {
            shape: (0..count).map(shape).collect(),
            normal: [0, 1, 2].map(numbers),
            position: [3, 4, 5].map(numbers),
        }
    }

    /// Rows of neighbours at a time give the weighted means over neighbours of the same shape.
    #[test]
    fn rows_are_means_over_neighbours() {
        let points = points();
        let values = [points.position[0].clone(), points.normal[1].clone()];
        let place = |k: usize| points.from(k, 1).point(0);
        for (radius, step) in [(1, 1), (2, 1), (2, 3), (4, 3)] {
            let filter = EdgeFilter {
                radius,
                step,
                width: 1.2,
            };
            let variance = (1.2 * step as f64).powi(2);
            for row in 0..SIZE[1] {
                let found = filter.row(&points, &values, SIZE, row);
                for (column, found) in found.iter().enumerate() {
                    let here = row * SIZE[0] + column;
                    let off = |there: usize| {
                        let off = [there % SIZE[0], there / SIZE[0]];
                        [off[0].abs_diff(column), off[1].abs_diff(row)]
                    };
                    let is_near = |there: &usize| {
                        let mut off = off(*there).into_iter();
                        off.all(|n| n % step == 0 && n <= radius * step)
                            && points.shape[*there] == points.shape[here]
                    };
                    let mut sums = [0.0; 3];
                    for there in (0..SIZE[0] * SIZE[1]).filter(is_near) {
                        let [x, y] = off(there).map(|n| n as f64);
                        let unlike = unlike_points(place(here), place(there));
                        let weight = bell((x * x + y * y) / variance + unlike);
                        let terms = [1.0, values[0][there], values[1][there]];
                        sums = [0, 1, 2].map(|k: usize| sums[k] + weight * terms[k]);
                    }
                    let is_shaded = points.shape[here] != NOT_SHADED;
                    let mean =
                        [1, 2].map(|k: usize| if is_shaded { sums[k] / sums[0] } else { 0.0 });
                    for k in 0..2 {
                        let off = (found[k] - mean[k]).abs();
                        assert!(off < 1e-13, "{found:?} {mean:?}"); // rounding
                    }
                }
            }
        }
    }
}
