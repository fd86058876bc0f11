//! Samples directions of an environment in proportion to its radiance.

use etendue_field::{Environment, EnvironmentMap, Frame, LatLong, SphericalGaussian, whole};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// A density over directions, which is proportional or nearly proportional to the radiance from
/// each direction.
#[derive(Clone, Debug)]
pub(crate) enum SkyDensity<'a> {
    /// The density of spherical Gaussians.
    Lobes(Lobes),
    /// The density of a map.
    Map(Box<Pixels<'a>>),
}

/// Spherical Gaussians prepared for sampling.
#[derive(Clone, Debug)]
pub(crate) struct Lobes {
    /// Cumulative shares of the light of the Gaussians.
    shares: Vec<f64>,
    /// Three values for each Gaussian: σ², exp(−2/σ²) − 1, and a frame whose D points in the
    /// direction from which most of the Gaussian's light comes.
    each: Vec<(f64, f64, Frame)>,
    /// The integral of the radiance over all directions.
    total: f64,
}

/// The cells of a map, prepared for sampling.
#[derive(Clone, Debug)]
pub(crate) struct Pixels<'a> {
    map: &'a LatLong,
    /// Cumulative shares of rows, from the top.
    rows: Vec<f64>,
    /// Cumulative shares of the cells of each row, from the left.
    cells: Vec<Vec<f64>>,
}

/// The density over a map weights light by the cosine at the surface. If the cosine is below this
/// value, this value is the weight.
const GRAZING: f64 = 0.05;

impl<'a> SkyDensity<'a> {
    /// The density for a surface with this normal, which is given in the frame at the
    /// light. Returns `None` if the environment is dark.
    pub(crate) fn new(environment: &'a Environment, normal: DVec3) -> Option<Self> {
        match &environment.map {
            EnvironmentMap::Lobes(lobes) => {
                let integrals = || lobes.iter().map(SphericalGaussian::integral);
                let axes = |lobe: &SphericalGaussian| {
                    let squared = lobe.width.powi(2);
                    let axes = Frame::IDENTITY.turned_to(lobe.from);
                    (squared, libm::expm1(-2.0 / squared), axes)
                };
                Some(Self::Lobes(Lobes {
                    shares: shares(integrals())?,
                    each: lobes.iter().map(axes).collect(),
                    total: integrals().sum(),
                }))
            }
            EnvironmentMap::LatLong(map) => {
                let frame = &environment.frame;
                let normal = frame.vector_to_local(normal);
                let forward = frame.vector_to_local(DVec3::NEG_Z);
                Pixels::new(map, normal, forward).map(|pixels| Self::Map(Box::new(pixels)))
            }
        }
    }

    /// Samples a direction from which light comes, as a unit vector in the axes of the environment.
    pub(crate) fn draw(&self, [a, b]: [f64; 2]) -> DVec3 {
        match self {
            Self::Lobes(lobes) => {
                let (i, a) = picked(&lobes.shares, a);
                let (squared, least, axes) = lobes.each[i];
                // `fall` is 1 − cos γ, sampled by the quantile function of the density exp((cos γ −
                // 1)/σ²).
                let fall = -squared * libm::log1p(a * least);
                let fall = fall.clamp(0.0, 2.0);
                let sin = (fall * (2.0 - fall)).sqrt();
                let (s, c) = libm::sincos(TAU * b);
                let local = DVec3::new(sin * c, sin * s, 1.0 - fall);
                axes.vector_to_world(local)
            }
            Self::Map(pixels) => pixels.draw([a, b]),
        }
    }

    /// The density of a direction per steradian, given the radiance from this direction.
    pub(crate) fn density(&self, from: DVec3, radiance: f64) -> f64 {
        match self {
            Self::Lobes(lobes) => radiance / lobes.total,
            Self::Map(pixels) => pixels.density(from),
        }
    }
}

impl<'a> Pixels<'a> {
    fn new(map: &'a LatLong, normal: DVec3, forward: DVec3) -> Option<Self> {
        let raster = map.raster();
        let [w, h] = [raster.width(), raster.height()];
        let pixel = |i: usize, j: usize| raster.value(i as f64 + 0.5, j as f64 + 0.5, true);
        // Between pixel centres, the radiance and the weight are interpolated from the pixels.
        let weight = |i: usize, j: usize| {
            let columns = [i + w - 1, i, i + 1].map(|i| i % w);
            let rows = [j.saturating_sub(1), j, (j + 1).min(h - 1)];
            let row = |j: usize| {
                let [a, b, c] = columns.map(|i| pixel(i, j));
                a + 2.0 * b + c
            };
            let [a, b, c] = rows.map(row);
            let from = map.direction([i as f64 + 0.5, j as f64 + 0.5]);
            // An environment emits light only forward. If a cell lies across the border of the
            // forward half, only a part of the cell emits light.
            let shines = from.dot(forward) > -(0.5 * PI / h as f64 + PI / w as f64);
            let cosine = from.dot(normal).max(GRAZING);
            if shines {
                (a + 2.0 * b + c) * cosine * solid_angle(h, j)
            } else {
                0.0
            }
        };
        let row = |j: usize| -> Vec<f64> { (0..w).map(|i| weight(i, j)).collect() };
        let weights: Vec<Vec<f64>> = (0..h).map(row).collect();
        let rows = shares(weights.iter().map(|row| row.iter().sum()))?;
        let even = || (1..=w).map(|i| i as f64 / w as f64).collect();
        let cells = weights
            .into_iter()
            .map(|row| shares(row).unwrap_or_else(even));
        Some(Self {
            map,
            rows,
            cells: cells.collect(),
        })
    }

    fn draw(&self, [a, b]: [f64; 2]) -> DVec3 {
        let (j, down) = picked(&self.rows, a);
        let (i, across) = picked(&self.cells[j], b);
        let h = self.rows.len();
        // Within a row, the density is uniform in the sine of the latitude.
        let [top, bottom] = [j, j + 1].map(|j| libm::sin(latitude(h, j)));
        let sine = (top + down * (bottom - top)).clamp(-1.0, 1.0);
        let row = h as f64 * (0.5 - libm::asin(sine) / PI);
        self.map.direction([i as f64 + across, row])
    }

    fn density(&self, from: DVec3) -> f64 {
        let [column, row] = self.map.place(from);
        let (h, w) = (self.rows.len(), self.cells[0].len());
        let j = whole(row.max(0.0)).min(h - 1);
        let i = whole(column.max(0.0)).min(w - 1);
        let solid_angle = solid_angle(h, j) * TAU / w as f64;
        share(&self.rows, j) * share(&self.cells[j], i) / solid_angle
    }
}

/// The latitude at which row j of h begins.
fn latitude(h: usize, j: usize) -> f64 {
    PI * (0.5 - j as f64 / h as f64)
}

/// The solid angle of a row of a map, per radian of longitude.
fn solid_angle(h: usize, j: usize) -> f64 {
    libm::sin(latitude(h, j)) - libm::sin(latitude(h, j + 1))
}

/// The cumulative shares of weights; `None` if all are zero.
fn shares(weights: impl IntoIterator<Item = f64>) -> Option<Vec<f64>> {
    let mut sum = 0.0;
    let mut sums: Vec<f64> = weights
        .into_iter()
        .map(|weight| {
            sum += weight;
            sum
        })
        .collect();
    for share in &mut sums {
        *share /= sum;
    }
    (sum > 0.0).then_some(sums)
}

/// The index of the part that contains a number in (0, 1), and the position of the number
/// within this part.
fn picked(shares: &[f64], at: f64) -> (usize, f64) {
    let i = shares
        .partition_point(|sum| *sum <= at)
        .min(shares.len() - 1);
    let before = shares[i] - share(shares, i);
    let into = (at - before) / share(shares, i);
    (
        i,
        if into.is_finite() {
            into.clamp(0.0, 1.0)
        } else {
            0.5
        },
    )
}

/// The share of one part.
fn share(shares: &[f64], i: usize) -> f64 {
    shares[i] - if i == 0 { 0.0 } else { shares[i - 1] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    /// Tests that all forward light of a map is sampled, even if the map has few columns.
    #[test]
    fn narrow_maps_lose_no_light() {
        let sizes = [[1, 1], [1, 8], [3, 64], [16, 8]].into_iter();
        let fronts = [DVec3::X, DVec3::Z, DVec3::NEG_Z];
        for ([w, h], front) in sizes.flat_map(|size| fronts.map(|front| (size, front))) {
            let map = LatLong::from_fn(w, h, |_| 1.0);
            let environment = Environment {
                frame: Frame::new(DVec3::ZERO, front, DVec3::Y).unwrap(),
                map: EnvironmentMap::LatLong(Arc::new(map)),
            };
            let sky = SkyDensity::new(&environment, DVec3::NEG_Z).unwrap();
            for i in 0..4000 {
                let t = f64::from(i);
                let (s, c) = libm::sincos(2.4 * t);
                let cos = (t + 0.5) / 4000.0;
                let sin = (1.0 - cos * cos).sqrt();
                // The sums are over forward directions.
                let from = environment.origin_of(DVec3::new(sin * c, sin * s, cos));
                assert!(sky.density(from, 1.0) > 0.0, "{w} x {h}: {from}");
            }
        }
    }
}
