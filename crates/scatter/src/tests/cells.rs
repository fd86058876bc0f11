//! Samples of a model counted in cells of the sphere, and its density integrated over them.

use super::models::Model;
use etendue_field::Frame;
use etendue_transform::random::{self, Stream};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

pub(super) const SAMPLES: u32 = 100_000;
/// Cells of a sphere around the mirror direction: by the angle to it, with equal shares of samples but for the last, and around it.
const SHARES: usize = 16;
const SECTORS: usize = 12;
/// Points of the midpoint rule along a side of a cell.
const FINE: u32 = 32;

/// Cells of the sphere for one given direction.
pub(super) struct Cells {
    pole: Frame,
    edges: Vec<f64>,
}

/// Samples against a density.
#[derive(Debug)]
pub(super) struct Comparison {
    chi2: f64,
    cells: f64,
    /// The integral of the density, less the share of numbers that draw a direction.
    excess: f64,
}

impl Comparison {
    /// Four and a half standard deviations of χ²: passed in one comparison of 300,000.
    ///
    /// The integral is that of the midpoint rule over some 200 cells of 32 × 32, of which the widest are cut by edges of the density, and the share
    /// is one of 100,000 samples.
    pub(super) fn agrees(&self) -> bool {
        self.chi2 < self.cells + 4.5 * (2.0 * self.cells).sqrt() && self.excess.abs() < 5e-3
    }
}

pub(super) fn numbers() -> impl Iterator<Item = [f64; 3]> {
    (0..u64::from(SAMPLES)).map(|index| {
        let [a, b, c, _] = random::words(5, Stream::Photon, index, 0).map(random::unit);
        [a, b, c]
    })
}

/// Directions that a model draws.
fn drawn(model: &Model, wo: DVec3) -> impl Iterator<Item = DVec3> {
    numbers().filter_map(move |random| model.bsdf.direction(wo, random))
}

impl Cells {
    /// Cells about the mirror direction of wo, whose rings hold equal shares of the samples.
    pub(super) fn new(model: &Model, wo: DVec3) -> Self {
        let pole = Frame::IDENTITY.turned_to(DVec3::new(-wo.x, -wo.y, wo.z));
        let mut angles: Vec<f64> = drawn(model, wo)
            .map(|wi| wi.angle_between(pole.d))
            .collect();
        angles.sort_by(f64::total_cmp);
        let mut edges = vec![0.0];
        edges.extend((1..SHARES).map(|i| angles[i * angles.len() / SHARES]));
        // The tail, and the end of Phong's lobe, where its density may jump.
        edges.extend([255, 4095].map(|i| angles[i * angles.len() / (i + 1)]));
        edges.extend([0.5 * PI, PI]);
        edges.sort_by(f64::total_cmp);
        Self { pole, edges }
    }

    /// ∫ f dω over each cell.
    pub(super) fn integrals(&self, f: impl Fn(DVec3) -> f64) -> Vec<f64> {
        let mut cells = Vec::new();
        for ring in self.edges.windows(2) {
            for sector in 0..SECTORS {
                let step = [ring[1] - ring[0], TAU / SECTORS as f64].map(|x| x / f64::from(FINE));
                let mut sum = 0.0;
                for i in 0..FINE {
                    let (sin, cos) = libm::sincos(ring[0] + (f64::from(i) + 0.5) * step[0]);
                    for j in 0..FINE {
                        let fine = f64::from(j) + 0.5;
                        let (y, x) =
                            libm::sincos(sector as f64 * TAU / SECTORS as f64 + fine * step[1]);
                        let local = DVec3::new(sin * x, sin * y, cos);
                        sum += f(self.pole.vector_to_world(local)) * sin;
                    }
                }
                cells.push(sum * step[0] * step[1]);
            }
        }
        cells
    }

    /// The cell of a direction.
    fn cell(&self, wi: DVec3) -> usize {
        let local = self.pole.vector_to_local(wi);
        let angle = local.angle_between(DVec3::Z);
        let rings = self.edges.len() - 1;
        let ring = self.edges[1..rings].partition_point(|edge| *edge <= angle);
        let turn = libm::atan2(local.y, local.x).rem_euclid(TAU) / TAU;
        let sector = etendue_field::whole(turn * SECTORS as f64).min(SECTORS - 1);
        ring * SECTORS + sector
    }

    /// The samples of a model against a density.
    pub(super) fn compare(
        &self,
        model: &Model,
        wo: DVec3,
        density: impl Fn(DVec3) -> f64,
    ) -> Comparison {
        let shares = self.integrals(density);
        let mut counts = vec![0.0; shares.len()];
        for wi in drawn(model, wo) {
            counts[self.cell(wi)] += 1.0;
        }
        let all = f64::from(SAMPLES);
        let excess = shares.iter().sum::<f64>() - counts.iter().sum::<f64>() / all;
        let [mut chi2, mut cells] = [0.0; 2];
        let mut add = |count: f64, expected: f64| {
            chi2 += (count - expected) * (count - expected) / expected;
            cells += 1.0;
        };
        // Cells with little in them are put together.
        let [mut rest, mut rest_expected] = [0.0; 2];
        for (count, share) in counts.iter().zip(&shares) {
            let expected = share * all;
            if expected > 20.0 {
                add(*count, expected);
            } else {
                rest += count;
                rest_expected += expected;
            }
        }
        if rest_expected > 5.0 {
            add(rest, rest_expected);
        }
        Comparison {
            chi2,
            cells,
            excess,
        }
    }
}
