//! Computes bandwidths of a picture along each direction in the plane of its two slopes.
//!
//! A picture is a windowed function of two slopes. The 2D spectrum of a picture is measured by
//! slices that contain only ρ = 0. Such a slice is a line through zero, and there is one line for
//! each azimuth. For each direction e, [`DirectionalBandwidth`] has the smallest B such that the
//! power at |ν · e| > B is at most a twentieth of the total power. Each frequency represents its
//! polar cell, whose power is spread uniformly over the range of ν · e within the cell.

use crate::bandwidth::{BANDWIDTH_FRACTION, Widest};
use crate::estimate::TooFewBatches;
use crate::jackknife::{Jackknife, Uncertain};
use crate::radial::CrossPower;
use crate::variation::transform;
use etendue_field::{SliceGrid, Slices, Window, whole};
use ndarray::{ArrayView3, Ix1, arr1};
use std::f64::consts::{FRAC_PI_2, PI};

/// The bandwidth along each azimuth of a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct DirectionalBandwidth {
    /// The bandwidths, cycles per unit slope, at the azimuths π k / K.
    pub along: Vec<f64>,
    /// The largest bandwidth, with its azimuth in radians. If several azimuths have the largest
    /// bandwidth, this is the first of them.
    pub widest: Widest<Uncertain>,
    /// The bandwidth along the direction that is perpendicular to the direction of `widest`.
    pub across: Uncertain,
    /// The total power, ∫ |F|² dν.
    pub power: Uncertain,
    /// The power that noise adds to the power of the mean spectrum; `power` does not include it.
    pub noise: f64,
}

fn noise_of(power: &CrossPower<'_>, grid: &SliceGrid) -> f64 {
    let noise = power.noise_at_azimuths();
    PolarPower::new(noise.view(), grid).map_or(0.0, |noise| noise.total)
}

impl DirectionalBandwidth {
    /// Computes the bandwidths of independent measurements of one picture.
    ///
    /// Returns `None` if the total power is not positive, either for all measurements together or
    /// if any one measurement is left out.
    ///
    /// # Errors
    ///
    /// Fails if there are fewer than three measurements.
    ///
    /// # Panics
    ///
    /// Panics if the slices have frequencies with ρ ≠ 0.
    pub fn new(pictures: &[Slices]) -> Result<Option<Self>, TooFewBatches> {
        let azimuths = pictures.first().map_or(0, |first| first.grid.azimuths);
        let power = CrossPower::of_replicates(pictures, 0..azimuths)?;
        let grid = pictures[0].grid;
        let mut each = power.at_azimuths();
        let found = each.next().and_then(|all| Self::of(all.view(), &grid));
        let Some(mut found) = found else {
            return Ok(None);
        };
        let widest = found.widest.azimuth;
        let mut jackknife = Jackknife::new(Ix1(3));
        for without in each {
            let Some(polar) = PolarPower::new(without.view(), &grid) else {
                return Ok(None);
            };
            let [along, across] = [widest, widest + FRAC_PI_2].map(|e| polar.bandwidth(e));
            jackknife.add(&arr1(&[along, across, polar.total]));
        }
        let errors = jackknife.variance().mapv(f64::sqrt);
        found.widest.value.error = errors[0];
        found.across.error = errors[1];
        found.power.error = errors[2];
        found.noise = noise_of(&power, &grid);
        Ok(Some(found))
    }

    /// The power that noise adds to the power of the mean spectrum.
    ///
    /// # Errors
    ///
    /// Fails if there are fewer than three measurements.
    pub fn noise(pictures: &[Slices]) -> Result<f64, TooFewBatches> {
        let azimuths = pictures.first().map_or(0, |first| first.grid.azimuths);
        let power = CrossPower::of_replicates(pictures, 0..azimuths)?;
        Ok(noise_of(&power, &pictures[0].grid))
    }

    /// The bandwidths of the spectrum of a window alone, without errors.
    ///
    /// # Panics
    ///
    /// Panics if the grid has frequencies with ρ ≠ 0.
    #[must_use]
    pub fn of_window(window: &Window, grid: &SliceGrid) -> Self {
        let power = transform(window, grid).mapv(|value| value * value);
        Self::of(power.view(), grid).expect("the spectrum of a window has power")
    }

    /// Computes the bandwidths of a power [azimuth, ρ ≥ 0, ν], without errors.
    fn of(power: ArrayView3<'_, f64>, grid: &SliceGrid) -> Option<Self> {
        let exact = |value| Uncertain { value, error: 0.0 };
        let polar = PolarPower::new(power, grid)?;
        let azimuths = (0..grid.azimuths).map(|k| grid.azimuth(k));
        let along: Vec<f64> = azimuths.map(|e| polar.bandwidth(e)).collect();
        let each = along.iter().enumerate();
        let (k, &most) = each.reduce(|most, next| if next.1 > most.1 { next } else { most })?;
        let azimuth = grid.azimuth(k);
        Some(Self {
            widest: Widest {
                azimuth,
                value: exact(most),
            },
            across: exact(polar.bandwidth(azimuth + FRAC_PI_2)),
            power: exact(polar.total),
            noise: 0.0,
            along,
        })
    }

    /// The bandwidth at the azimuth nearest to a given azimuth, in radians.
    #[must_use]
    pub fn at(&self, azimuth: f64) -> f64 {
        let count = self.along.len();
        let turns = (azimuth / PI).rem_euclid(1.0);
        self.along[whole(turns * count as f64 + 0.5) % count]
    }
}

/// The power of a picture, divided into polar cells.
struct PolarPower<'a> {
    grid: &'a SliceGrid,
    cells: Vec<PolarCell>,
    total: f64,
}

impl<'a> PolarPower<'a> {
    /// Returns `None` if the total power is not positive.
    fn new(power: ArrayView3<'_, f64>, grid: &'a SliceGrid) -> Option<Self> {
        assert_eq!(
            grid.rho.half, 0,
            "the grid of a picture has only frequencies with ρ = 0"
        );
        let cells = power.indexed_iter();
        let cells = cells.map(|((k, _, n), power)| PolarCell::new(grid, [k, n], *power));
        let cells: Vec<PolarCell> = cells.collect();
        let total: f64 = cells.iter().map(|cell| cell.power).sum();
        (total > 0.0).then_some(Self { grid, cells, total })
    }

    /// The bandwidth along a direction e.
    fn bandwidth(&self, azimuth: f64) -> f64 {
        let mut within = Cumulative::new(self.grid);
        for cell in &self.cells {
            within.add(cell, azimuth);
        }
        within.reaches(BANDWIDTH_FRACTION * self.total)
    }
}

/// The cell of a frequency on a polar grid.
struct PolarCell {
    azimuth: f64,
    /// The frequency along the azimuth.
    nu: f64,
    /// Half of the length of each side of the cell: along the azimuth, and perpendicular to the
    /// azimuth.
    half: [f64; 2],
    /// The power in the cell, ∫ |F|².
    power: f64,
}

impl PolarCell {
    fn new(grid: &SliceGrid, [k, n]: [usize; 2], density: f64) -> Self {
        let nu = grid.nu.value(n);
        let turn = PI / grid.azimuths as f64;
        let step = grid.nu.spacing;
        // At frequency zero, the cells of all azimuths share a disc of radius step / 2.
        let area = if n == grid.nu.half {
            0.25 * step * step * turn
        } else {
            nu.abs() * step * turn
        };
        Self {
            azimuth: grid.azimuth(k),
            nu,
            half: [0.5 * step, 0.5 * nu.abs() * turn],
            power: area * density,
        }
    }
}

/// A cumulative sum of power. For each of many limits, it gives the power at |ν · e| below the
/// limit.
struct Cumulative {
    step: f64,
    /// The power between each limit and the next limit.
    bins: Vec<f64>,
}

/// Number of bins per frequency step of the grid.
const BINS: f64 = 8.0;

impl Cumulative {
    fn new(grid: &SliceGrid) -> Self {
        let step = grid.nu.spacing / BINS;
        // A cell extends beyond the last frequency by at most half a step plus the length of the
        // cell's side.
        let most = 2.0 * (grid.nu.max() + grid.nu.spacing);
        Self {
            step,
            bins: vec![0.0; whole(most / step) + 2],
        }
    }

    fn add(&mut self, cell: &PolarCell, along: f64) {
        let (sin, cos) = libm::sincos(cell.azimuth - along);
        let middle = (cell.nu * cos).abs();
        let half = cell.half[0] * cos.abs() + cell.half[1] * sin.abs();
        let [low, high] = [middle - half, middle + half].map(|end| end / self.step);
        let per_bin = cell.power / (high - low);
        // The part of the cell's range that lies below zero is reflected to positive frequencies.
        for [low, high] in [[low.max(0.0), high], [0.0, -low]] {
            if high <= low {
                continue;
            }
            for bin in whole(low)..=whole(high) {
                let from = low.max(bin as f64);
                let to = high.min(bin as f64 + 1.0);
                self.bins[bin] += per_bin * (to - from).max(0.0);
            }
        }
    }

    /// The first limit below which the power is at least `wanted`.
    fn reaches(&self, wanted: f64) -> f64 {
        let mut within = 0.0;
        for (bin, power) in self.bins.iter().enumerate() {
            if within + power >= wanted {
                return (bin as f64 + (wanted - within) / power) * self.step;
            }
            within += power;
        }
        // The search ends without a result only because of rounding errors.
        self.bins.len() as f64 * self.step
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::variation::WindowedMean;
    use etendue_field::{Complex, FrequencyAxis, Profile};

    /// The grid of a probe for a window of half-width 1.
    fn grid() -> SliceGrid {
        SliceGrid {
            azimuths: 40,
            rho: FrequencyAxis {
                half: 0,
                spacing: 1.0,
            },
            nu: FrequencyAxis {
                half: 24,
                spacing: 0.25,
            },
        }
    }

    fn window() -> Window {
        let [small, one] = [1e-9, 1.0].map(Profile::Hann);
        Window {
            x: small,
            y: small,
            u: one,
            v: one,
        }
    }

    /// The spectrum of a + b cos(2π f · (u, v)) behind the window, divided by the
    /// spectrum of the point in x.
    fn wave(mean: f64, contrast: f64, frequency: [f64; 2]) -> Slices {
        let (grid, window) = (grid(), window());
        let mut slices = Slices::zeros(grid);
        let at = |u: f64, v: f64| window.u.transform(u) * window.v.transform(v);
        let point = window.x.transform(0.0).powi(2);
        for ((k, _, n), value) in slices.half.indexed_iter_mut() {
            let [_, _, u, v] = grid.frequency(k, 0.0, grid.nu.value(n));
            let [f, g] = frequency;
            let sides = at(u - f, v - g) + at(u + f, v + g);
            *value = Complex::from(point * (mean * at(u, v) + 0.5 * contrast * sides));
        }
        slices
    }

    fn less_mean(slices: &Slices) -> Slices {
        WindowedMean::new(&window(), &grid()).removed_from(slices)
    }

    fn alone(slices: &Slices) -> DirectionalBandwidth {
        let copies = vec![slices.clone(); 4];
        DirectionalBandwidth::new(&copies).unwrap().unwrap()
    }

    #[test]
    fn a_window_has_the_bandwidth_of_its_profile() {
        let found = DirectionalBandwidth::of_window(&window(), &grid());
        // The midpoint rule gives the expected bandwidth 0.55722 along the axes. The polar cells
        // change the bandwidth by up to 2 %.
        for azimuth in [0.0, FRAC_PI_2] {
            let value = found.at(azimuth);
            assert!((value - 0.557).abs() < 0.012, "{value}");
        }
    }

    /// Tests sines without their mean at several azimuths. The bandwidth of a sine of frequency f
    /// is |f| plus the width of the window's main lobe. Along a direction e, it has the bandwidth
    /// of a sine of frequency f · e.
    #[test]
    fn a_sine_of_any_azimuth_and_contrast() {
        for (azimuth, contrast) in [(0.0, 1.0), (0.41, 0.2), (1.2, 0.03)] {
            let frequency = 3.3;
            let (sin, cos) = libm::sincos(azimuth);
            let field = wave(1.0, contrast, [frequency * cos, frequency * sin]);
            let found = alone(&less_mean(&field));
            let widest = found.widest;
            // The frequencies from −∞ to 0.47 hold 95 % of a Hann window's power.
            let wanted = frequency + 0.47;
            let value = widest.value.value;
            assert!((value - wanted).abs() < 0.1, "{value} {wanted}"); // diagonals, cells
            let along = PI / 40.0;
            let turned = (widest.azimuth - azimuth).abs();
            assert!(turned < 4.0 * along, "{turned}"); // near the maximum all are equal
            let across = found.across.value;
            assert!(across < 1.1, "{across}");
        }
    }

    #[test]
    fn the_mean_of_a_picture_hides_its_bandwidth() {
        let field = wave(1.0, 0.2, [3.3, 0.0]);
        assert!(alone(&field).widest.value.value < 1.0);
        // A mean that is not removed hides the bandwidth of the sine. If the mean is removed a
        // second time, the result does not change.
        let found = alone(&less_mean(&field)).widest.value.value;
        let twice = less_mean(&less_mean(&field));
        assert!((alone(&twice).widest.value.value - found).abs() < 1e-9); // rounding
    }

    #[test]
    fn even_light_has_no_variation() {
        let field = wave(1.0, 0.0, [0.0; 2]);
        let left = alone_power(&less_mean(&field));
        assert!(left < 1e-20 * alone(&field).power.value, "{left:e}");
    }

    fn alone_power(slices: &Slices) -> f64 {
        slices.half.iter().map(|s| s.norm_sqr()).sum()
    }
}
