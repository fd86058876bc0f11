//! Directions in proportion to the radiance of an environment.

use crate::line::{direction, ray_through};
use crate::sampling::{LAMBERTIAN, by_cosine};
use etendue_field::{Environment, EnvironmentMap, Frame, LatLong, SphericalGaussian, TwoPlane};
use etendue_transform::random::{self, Stream};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// An environment, and how directions of its light are drawn.
#[derive(Clone, Debug)]
pub(crate) struct Sky {
    environment: Environment,
    choice: Choice,
    /// The share of slopes that are drawn by the cosine instead: where most light goes back, what is
    /// left goes forward too seldom.
    by_cosine: f64,
}

/// What is chosen from, and running sums of its flux.
#[derive(Clone, Debug)]
enum Choice {
    Lobes(Vec<SphericalGaussian>, Vec<f64>),
    /// The rows of a map, and the pixels in each row.
    Map {
        map: Arc<LatLong>,
        rows: Vec<f64>,
        columns: Vec<Vec<f64>>,
    },
}

/// Directions drawn to see how many go forward.
const TRIED: u64 = 1000;
/// Some are always drawn by the light, and some by the cosine.
const MOST_BY_COSINE: f64 = 0.9;
const LEAST_BY_COSINE: f64 = 0.1;

/// Running sums of numbers.
fn running(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut sum = 0.0;
    let sums = values.map(|value| {
        sum += value;
        sum
    });
    sums.collect()
}

fn total(sums: &[f64]) -> f64 {
    sums.last().copied().unwrap_or(0.0)
}

/// One of the numbers with these running sums, in proportion to it, from a number in (0, 1).
fn chosen(sums: &[f64], r: f64) -> usize {
    let wanted = r * total(sums);
    let i = sums.partition_point(|upto| *upto < wanted);
    i.min(sums.len() - 1)
}

/// A number in (−1, 1) with density 1 − |t|, from one in (0, 1).
fn tent(r: f64) -> f64 {
    if r < 0.5 {
        (2.0 * r).sqrt() - 1.0
    } else {
        1.0 - (2.0 * (1.0 - r)).sqrt()
    }
}

/// Cosine of the latitude of the centres of a row.
fn cosine(row: usize, height: usize) -> f64 {
    libm::cos(PI * (0.5 - (row as f64 + 0.5) / height as f64))
}

impl Sky {
    pub(crate) fn new(environment: &Environment) -> Self {
        let choice = match &environment.map {
            EnvironmentMap::Lobes(lobes) => {
                let upto = running(lobes.iter().map(SphericalGaussian::integral));
                Choice::Lobes(lobes.clone(), upto)
            }
            EnvironmentMap::LatLong(map) => {
                let raster = map.raster();
                let rows = raster.values().chunks_exact(raster.width()).enumerate();
                let columns: Vec<Vec<f64>> = rows
                    .map(|(row, values)| {
                        let cosine = cosine(row, raster.height());
                        running(values.iter().map(|value| cosine * value))
                    })
                    .collect();
                let rows = running(columns.iter().map(|row| total(row)));
                let map = Arc::clone(map);
                Choice::Map { map, rows, columns }
            }
        };
        let mut sky = Self {
            environment: environment.clone(),
            choice,
            by_cosine: 0.0,
        };
        let tried = (0..TRIED).map(|i| random::words(0, Stream::Even, i, 0).map(random::unit));
        let forward = tried.filter(|r| sky.sample(*r).z > FORWARD).count();
        let share = forward as f64 / TRIED as f64;
        sky.by_cosine = (1.0 - 2.0 * share).clamp(LEAST_BY_COSINE, MOST_BY_COSINE);
        sky
    }

    /// A direction in which light travels, of unit length, in the frame at the light; from four numbers in (0, 1).
    pub(crate) fn sample(&self, r: [f64; 4]) -> DVec3 {
        let from = match &self.choice {
            Choice::Lobes(lobes, upto) => {
                let lobe = &lobes[chosen(upto, r[0])];
                let squared = lobe.width * lobe.width;
                // 1 − cos γ.
                let fall = -squared * libm::log1p(r[1] * libm::expm1(-2.0 / squared));
                let fall = fall.clamp(0.0, 2.0);
                let sine = (fall * (2.0 - fall)).sqrt();
                let (s, c) = libm::sincos(TAU * r[2]);
                let local = DVec3::new(sine * c, sine * s, 1.0 - fall);
                let around = Frame::IDENTITY.turned_to(lobe.from);
                around.vector_to_world(local)
            }
            Choice::Map { map, rows, columns } => {
                let row = chosen(rows, r[0]);
                let column = chosen(&columns[row], r[1]);
                // Bilinear interpolation is a sum of tents around the centres, folded back at the poles.
                let height = rows.len() as f64;
                let down = (row as f64 + 0.5 + tent(r[3])).abs();
                let down = height - (height - down).abs();
                map.direction([column as f64 + 0.5 + tent(r[2]), down])
            }
        };
        -self.environment.frame.vector_to_world(from)
    }

    /// The density of [`Self::sample`] per steradian.
    pub(crate) fn density(&self, along: DVec3) -> f64 {
        let from = self.environment.origin_of(along);
        match &self.choice {
            Choice::Lobes(_, upto) => self.environment.map.radiance(from) / total(upto),
            Choice::Map { map, rows, .. } => {
                let raster = map.raster();
                let [column, row] = map.place(from);
                let around = raster.around(column, row, true).into_iter();
                let weighted = around.map(|(pixel, share)| {
                    share * raster.values()[pixel] * cosine(pixel / raster.width(), raster.height())
                });
                let [w, h] = [raster.width() as f64, raster.height() as f64];
                // A square of latitude and longitude, and its solid angle.
                let pixel = (TAU / w)
                    * (PI / h)
                    * DVec2::new(from.x, from.z).length().max(f64::MIN_POSITIVE);
                weighted.sum::<f64>() / (total(rows) * pixel)
            }
        }
    }

    /// The slopes of a direction; `None` when it does not go forward.
    pub(crate) fn slopes(&self, r: [f64; 4]) -> Option<[f64; 2]> {
        let along = if r[0] < self.by_cosine {
            by_cosine([r[2], r[1]])
        } else {
            let first = (r[0] - self.by_cosine) / (1.0 - self.by_cosine);
            self.sample([first, r[1], r[2], r[3]])
        };
        (along.z > FORWARD).then(|| [along.x / along.z, along.y / along.z])
    }

    /// The density of [`Self::slopes`] with respect to du dv.
    #[inline]
    pub(crate) fn slope_density(&self, ray: &TwoPlane) -> f64 {
        let secant_squared = ray.secant_squared();
        let by_cosine = 1.0 / (LAMBERTIAN * secant_squared.sqrt());
        let by_light = self.density(direction(ray));
        let density = self.by_cosine * by_cosine + (1.0 - self.by_cosine) * by_light;
        density / (secant_squared * secant_squared.sqrt())
    }

    /// Radiance along a ray, in the frame at the light.
    #[inline]
    pub(crate) fn radiance(&self, ray: &TwoPlane) -> f64 {
        radiance(&self.environment, ray)
    }

    /// The irradiance at a point with this normal, from one direction, drawn by the cosine or by the environment with equal chances; `incident`
    /// says what radiance arrives along a ray at a distance on the first leg.
    pub(crate) fn irradiance(
        &self,
        point: DVec3,
        normal: DVec3,
        r: [f64; 4],
        incident: impl FnOnce(&TwoPlane, f64) -> f64,
    ) -> f64 {
        let towards = if r[3] < 0.5 {
            let towards = by_cosine([r[0], r[1]]);
            Frame::IDENTITY.turned_to(normal).vector_to_world(towards)
        } else {
            -self.sample([r[0], r[1], r[2], 2.0 * r[3] - 1.0])
        };
        let cosine = towards.dot(normal);
        let Some(ray) = ray_through(point, -towards).filter(|_| cosine > 0.0) else {
            return 0.0;
        };
        // Veach and Guibas 1995: the balance heuristic of one sample.
        let density = 0.5 * (cosine / LAMBERTIAN + self.density(-towards));
        cosine * incident(&ray, point.z) / density
    }
}

/// Radiance along a ray, in the frame at the light.
#[inline]
pub(crate) fn radiance(environment: &Environment, ray: &TwoPlane) -> f64 {
    if ray.secant_squared() * FORWARD * FORWARD < 1.0 {
        environment.radiance(direction(ray))
    } else {
        0.0
    }
}

/// Cosine of the angle to the central ray from which on light goes forward.
const FORWARD: f64 = 1e-6;

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_field::LatLong;
    use etendue_transform::random::{self, Stream};
    use std::sync::Arc;

    fn environments() -> Vec<Environment> {
        let lobe = |from: DVec3, width, radiance| SphericalGaussian {
            from: from.normalize(),
            radiance,
            width,
        };
        let lobes = vec![
            lobe(DVec3::new(0.3, 0.5, -1.0), 0.3, 2.0),
            lobe(DVec3::NEG_Y, 0.8, 0.5),
            lobe(DVec3::X, 1000.0, 0.1),
        ];
        // Bright on one pixel at the left edge, so that light goes round, and at the poles.
        let map = LatLong::from_fn(12, 7, |d| {
            let edge = d.z < -0.8 && d.x > 0.0;
            if edge { 4.0 } else { 0.2 * d.y * d.y }
        });
        let frame = Frame::new(
            DVec3::ZERO,
            DVec3::new(0.3, -0.4, 0.8),
            DVec3::new(1.0, 0.2, 0.0),
        );
        [
            EnvironmentMap::Lobes(lobes),
            EnvironmentMap::LatLong(Arc::new(map)),
        ]
        .map(|map| Environment {
            frame: frame.unwrap(),
            map,
        })
        .to_vec()
    }

    /// χ² of samples against the density, over cells of longitude and of the sine of latitude, and the density's whole integral.
    #[test]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the number of a cell"
    )]
    fn directions_follow_the_density() {
        const CELLS: [usize; 2] = [24, 16];
        const SUB: usize = 40;
        const SAMPLES: u32 = 400_000;
        for environment in environments() {
            let sky = Sky::new(&environment);
            let mut counts = vec![0.0; CELLS[0] * CELLS[1]];
            for index in 0..u64::from(SAMPLES) {
                let r = random::words(5, Stream::Photon, index, 0).map(random::unit);
                let d = sky.sample(r);
                assert!((d.length() - 1.0).abs() < 1e-12); // rounding
                let [i, j] = [libm::atan2(d.y, d.x) / TAU + 0.5, 0.5 * (d.z + 1.0)];
                let cell = |t: f64, n: usize| ((t * n as f64) as usize).min(n - 1);
                counts[cell(i, CELLS[0]) * CELLS[1] + cell(j, CELLS[1])] += 1.0;
            }
            let (mut total, mut chi2, mut cells) = (0.0, 0.0, 0.0_f64);
            let n = CELLS.map(|c| c * SUB);
            for (cell, count) in counts.iter().enumerate() {
                let corner = [cell / CELLS[1], cell % CELLS[1]];
                let mut p = 0.0;
                for k in 0..SUB * SUB {
                    let [a, z] = [(0, k / SUB), (1, k % SUB)]
                        .map(|(axis, s)| ((corner[axis] * SUB + s) as f64 + 0.5) / n[axis] as f64);
                    let (sin, cos) = libm::sincos(TAU * (a - 0.5));
                    let z = 2.0 * z - 1.0;
                    let across = (1.0 - z * z).sqrt();
                    p += sky.density(DVec3::new(across * cos, across * sin, z));
                }
                p *= TAU * 2.0 / (n[0] * n[1]) as f64;
                total += p;
                let expected = p * f64::from(SAMPLES);
                if expected > 10.0 {
                    chi2 += (count - expected).powi(2) / expected;
                    cells += 1.0;
                }
            }
            // Mid-points of some 600,000 cells: kinks at the edges of pixels, and 1/cos of the latitude at the map's poles.
            assert!((total - 1.0).abs() < 2e-3, "integral {total}");
            let bound = cells + 5.0 * (2.0 * cells).sqrt(); // five standard deviations of χ²
            assert!(chi2 < bound, "χ² {chi2} in {cells} cells");
            assert!(cells > 100.0, "{cells} cells");
        }
    }
}
