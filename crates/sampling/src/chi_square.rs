//! Pearson's χ² test, for tests of samplers. It compares the counts of samples in cells with the
//! integrals of the density over these cells.

use etendue_field::Frame;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Number of points of the midpoint rule along a side of a cell.
const FINE: u32 = 32;
/// Number of rings of cells on a sphere. Each ring is divided into sectors, and all rings except
/// the last ones have equal shares of the samples.
const RINGS: usize = 16;
const SECTORS: usize = 12;
/// Cells with fewer expected samples than this are merged.
const MIN_EXPECTED: f64 = 20.0;

/// A comparison of samples with a density.
#[derive(Clone, Copy, Debug)]
pub struct ChiSquare {
    chi2: f64,
    cells: f64,
    /// The excess is the integral of the density, minus the share of random numbers that yield a
    /// sample.
    excess: f64,
}

impl ChiSquare {
    /// Compares the counts of samples in some cells with the integrals of the density over these
    /// cells. `all` is the number of random numbers with which the samples were drawn.
    fn new(counts: &[f64], shares: &[f64], all: f64) -> Self {
        let excess = shares.iter().sum::<f64>() - counts.iter().sum::<f64>() / all;
        let [mut chi2, mut cells] = [0.0; 2];
        let mut add = |count: f64, expected: f64| {
            chi2 += (count - expected) * (count - expected) / expected;
            cells += 1.0;
        };
        let [mut rest, mut rest_expected] = [0.0; 2];
        for (count, share) in counts.iter().zip(shares) {
            let expected = share * all;
            if expected > MIN_EXPECTED {
                add(*count, expected);
            } else {
                rest += count;
                rest_expected += expected;
            }
        }
        if rest_expected > 0.25 * MIN_EXPECTED {
            add(rest, rest_expected);
        }
        Self {
            chi2,
            cells,
            excess,
        }
    }

    /// Checks that χ² is within four and a half standard deviations. One comparison in 300,000
    /// exceeds this limit by chance.
    ///
    /// Also checks that the excess is below 0.005, which allows for two errors. The integral comes
    /// from a midpoint rule of 32 × 32 points in each cell, and edges of the density cut some
    /// cells. The share comes from about 100,000 samples.
    #[must_use]
    pub fn agrees(&self) -> bool {
        self.chi2 < self.cells + 4.5 * (2.0 * self.cells).sqrt() && self.excess.abs() < 5e-3
    }
}

/// Cells of a rectangle.
#[derive(Clone, Debug)]
pub struct RectangleCells {
    edges: [Vec<f64>; 2],
}

impl RectangleCells {
    /// Returns equal cells between the lowest and the highest coordinate along each axis.
    #[must_use]
    pub fn new(bounds: [[f64; 2]; 2], counts: [usize; 2]) -> Self {
        let edges = [0, 1].map(|axis| {
            let [low, high] = bounds[axis];
            let step = (high - low) / counts[axis] as f64;
            (0..=counts[axis]).map(|i| low + i as f64 * step).collect()
        });
        Self { edges }
    }

    /// ∫ f over each cell.
    fn integrals(&self, f: impl Fn([f64; 2]) -> f64) -> Vec<f64> {
        let [first, second] = &self.edges;
        let cells = first
            .windows(2)
            .flat_map(|a| second.windows(2).map(move |b| [[a[0], a[1]], [b[0], b[1]]]));
        let integral = |cell: [[f64; 2]; 2]| {
            let [a, b] = cell.map(|[low, high]| {
                let step = (high - low) / f64::from(FINE);
                (0..FINE).map(move |i| low + (f64::from(i) + 0.5) * step)
            });
            let sum: f64 = a.flat_map(|a| b.clone().map(move |b| [a, b])).map(&f).sum();
            let [width, height] = cell.map(|[low, high]| high - low);
            sum * width * height / f64::from(FINE * FINE)
        };
        cells.map(integral).collect()
    }

    /// The cell of a point. If the point is beyond the outermost edges, returns the nearest
    /// cell.
    fn cell(&self, point: [f64; 2]) -> usize {
        let [i, j] = [0, 1].map(|axis| {
            let edges = &self.edges[axis];
            edges[1..edges.len() - 1].partition_point(|edge| *edge <= point[axis])
        });
        i * (self.edges[1].len() - 1) + j
    }

    /// Compares samples with a density that is 0 beyond the rectangle. Some random numbers yield no
    /// sample.
    pub fn compare(
        &self,
        samples: impl IntoIterator<Item = Option<[f64; 2]>>,
        density: impl Fn([f64; 2]) -> f64,
    ) -> ChiSquare {
        let shares = self.integrals(density);
        let mut counts = vec![0.0; shares.len()];
        let mut all = 0.0;
        for sample in samples {
            all += 1.0;
            if let Some(point) = sample {
                counts[self.cell(point)] += 1.0;
            }
        }
        ChiSquare::new(&counts, &shares, all)
    }
}

/// Cells of the sphere, by the angle to a pole and the azimuth around it.
#[derive(Clone, Debug)]
pub struct SphereCells {
    pole: Frame,
    cells: RectangleCells,
}

impl SphereCells {
    /// Returns cells about a pole. The rings of these cells contain equal shares of the given
    /// directions.
    #[must_use]
    pub fn new(pole: DVec3, directions: impl IntoIterator<Item = DVec3>) -> Self {
        let pole = Frame::IDENTITY.turned_to(pole);
        let directions = directions.into_iter();
        let mut angles: Vec<f64> = directions.map(|d| d.angle_between(pole.d)).collect();
        angles.sort_by(f64::total_cmp);
        let mut rings = vec![0.0];
        rings.extend((1..RINGS).map(|i| angles[i * angles.len() / RINGS]));
        // The additional rings resolve the tail of a lobe, and the edge of a lobe, where the
        // density may jump.
        rings.extend([255, 4095].map(|i| angles[i * angles.len() / (i + 1)]));
        rings.extend([0.5 * PI, PI]);
        rings.sort_by(f64::total_cmp);
        let sectors = (0..=SECTORS).map(|i| i as f64 / SECTORS as f64).collect();
        let edges = [rings, sectors];
        Self {
            pole,
            cells: RectangleCells { edges },
        }
    }

    /// ∫ f dω over each cell.
    pub fn integrals(&self, f: impl Fn(DVec3) -> f64) -> Vec<f64> {
        self.cells.integrals(self.unrolled(f))
    }

    /// Compares samples with a density per steradian. Some random numbers yield no sample.
    pub fn compare(
        &self,
        samples: impl IntoIterator<Item = Option<DVec3>>,
        density: impl Fn(DVec3) -> f64,
    ) -> ChiSquare {
        let samples = samples.into_iter();
        let places = samples.map(|sample| sample.map(|direction| self.place(direction)));
        self.cells.compare(places, self.unrolled(density))
    }

    /// The angle of a direction to the pole, and its azimuth divided by 2π.
    fn place(&self, direction: DVec3) -> [f64; 2] {
        let local = self.pole.vector_to_local(direction);
        let turn = libm::atan2(local.y, local.x) / TAU;
        [local.angle_between(DVec3::Z), turn.rem_euclid(1.0)]
    }

    /// Converts a density over the sphere to a density over the angle to the pole and the azimuth
    /// divided by 2π.
    fn unrolled(&self, f: impl Fn(DVec3) -> f64) -> impl Fn([f64; 2]) -> f64 {
        move |[angle, turn]| {
            let (sin, cos) = libm::sincos(angle);
            let (y, x) = libm::sincos(TAU * turn);
            let local = DVec3::new(sin * x, sin * y, cos);
            f(self.pole.vector_to_world(local)) * sin * TAU
        }
    }
}
