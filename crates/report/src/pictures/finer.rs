//! Interpolates spectra between the frequencies of a scene, for pictures without visible cells.
//!
//! The window bounds the light field, so the spectrum between given frequencies is determined by
//! these frequencies. Many windowed light fields W ℓ have the given values; the picture shows the
//! one with the least ∫ ℓ². The spectrum of the drawn light field is a weighted sum of the given
//! values. The weights follow from K(Ω) = ∫ W² e^(−2πi Ω z) dz / ∫ W². K is the covariance between
//! frequencies of white noise that is multiplied by the window.

use etendue_compare::{PlaneComparison, solved};
use etendue_field::{Complex, FrequencyAxis, Profile, SliceGrid, Slices, VirtualPlane, Window};
use ndarray::{Array1, Array2, ArrayView2, Axis, Slice};
use std::f64::consts::TAU;

/// If an axis has more cells than this number, single cells are not visible.
const SMOOTH: usize = 160;
/// The given values must determine an intermediate value: at most this share of its variance may
/// remain.
const OPEN: f64 = 0.01;
/// The number added to the diagonal of a covariance, because neighbouring frequencies are nearly
/// dependent.
const RIDGE: f64 = 1e-8;

/// The weights of a plane's frequencies that give values at finer frequencies.
pub(super) struct Finer {
    grid: SliceGrid,
    /// The weights along ρ ≥ 0 and along ν for each azimuth.
    weights: Vec<[AxisWeights; 2]>,
}

/// The weights along an axis, as an array [finer, given]; `None` if the given frequencies are fine
/// enough.
type AxisWeights = Option<Array2<f64>>;

impl Finer {
    /// Returns finer frequencies over the same range. Returns `None` in two cases: the scene's
    /// frequencies are fine enough for the picture, or they are too far apart to determine the
    /// values between them.
    pub(super) fn new(given: &SliceGrid, window: &Window) -> Option<Self> {
        let grid = SliceGrid {
            azimuths: given.azimuths,
            rho: divided(&given.rho),
            nu: divided(&given.nu),
        };
        let of_azimuth = |azimuth| {
            let toward = libm::sincos(given.azimuth(azimuth));
            let positions = WindowCovariance::new([window.x, window.y], toward);
            let slopes = WindowCovariance::new([window.u, window.v], toward);
            let rows = weights(&given.rho, &grid.rho, &positions)?;
            let columns = weights(&given.nu, &grid.nu, &slopes)?;
            let positive = Slice::from(grid.rho.half..);
            let rows = rows.map(|rows| rows.slice_axis(Axis(0), positive).to_owned());
            Some([rows, columns])
        };
        if grid == *given {
            return None;
        }
        let weights: Option<Vec<_>> = (0..grid.azimuths).map(of_azimuth).collect();
        Some(Self {
            grid,
            weights: weights?,
        })
    }

    /// The spectrum on the finer frequencies.
    pub(super) fn of(&self, slices: &Slices) -> Slices {
        let mut finer = Slices::zeros(self.grid);
        let full = slices.full();
        let each = finer.half.outer_iter_mut().zip(full.outer_iter());
        for ((mut finer, slice), [rows, columns]) in each.zip(&self.weights) {
            let by_row = match rows {
                Some(rows) => product(rows.view(), slice),
                None => slice
                    .slice_axis(Axis(0), Slice::from(self.grid.rho.half..))
                    .to_owned(),
            };
            match columns {
                Some(columns) => {
                    let by_column = by_row.t().as_standard_layout().into_owned();
                    finer.assign(&product(columns.view(), by_column.view()).t());
                }
                None => finer.assign(&by_row),
            }
        }
        finer
    }
}

/// The measured and the predicted radial power of a plane between the frequencies of the scene.
pub(super) fn finer_powers(at: &VirtualPlane, plane: &PlaneComparison) -> Option<[Array2<f64>; 2]> {
    let finer = Finer::new(&plane.measured.grid, &at.window)?;
    let of = |slices, power| finer_power(&finer.of(slices), slices, power);
    Some([
        of(&plane.measured, &plane.radial.power),
        of(&plane.predicted, &plane.predicted_radial),
    ])
}

/// The mean power over azimuths at the finer frequencies. The noise that was removed from
/// `power`, at the frequencies of the scene, is also removed here.
fn finer_power(finer: &Slices, slices: &Slices, power: &Array2<f64>) -> Array2<f64> {
    let noise = slices.radial_power() - power;
    let (from, to) = (&slices.grid, &finer.grid);
    let rows = linear(&from.rho, &to.rho);
    let columns = linear(&from.nu, &to.nu);
    let mut finer = finer.radial_power();
    for ((i, j), value) in finer.indexed_iter_mut() {
        let (row, column) = (rows[i], columns[j]);
        for (m, by_row) in row {
            for (n, by_column) in column {
                *value -= by_row * by_column * noise[[m, n]];
            }
        }
    }
    finer
}

/// Returns finer frequencies. Their number for each given frequency is odd, so each given frequency
/// is also a finer frequency.
fn divided(axis: &FrequencyAxis) -> FrequencyAxis {
    let parts = SMOOTH.div_ceil(axis.count());
    let parts = parts + usize::from(parts.is_multiple_of(2));
    FrequencyAxis {
        half: (parts * axis.count() - 1) / 2,
        spacing: axis.spacing / parts as f64,
    }
}

/// The two given frequencies around each finer frequency, with their weights.
fn linear(from: &FrequencyAxis, to: &FrequencyAxis) -> Vec<[(usize, f64); 2]> {
    let last = from.count() - 1;
    let place = |value: f64| {
        let at = (value / from.spacing + from.half as f64).clamp(0.0, last as f64);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "the index is between 0 and the number of frequencies"
        )]
        let low = (at.floor() as usize).min(last.saturating_sub(1));
        let share = at - low as f64;
        [(low, 1.0 - share), ((low + 1).min(last), share)]
    };
    to.values().into_iter().map(place).collect()
}

/// The covariance between frequencies of a slice, for white noise that is multiplied by a window.
struct WindowCovariance {
    /// For both profiles of the window, points along half of the slice; the other half is its
    /// mirror image. The weight of a point is the square of the profile.
    profiles: [Vec<(f64, f64)>; 2],
}

impl WindowCovariance {
    fn new(profiles: [Profile; 2], (sin, cos): (f64, f64)) -> Self {
        const POINTS: u32 = 100;
        let points = |profile: Profile, toward: f64| {
            let all = (0..POINTS).map(|i| {
                let t = profile.half_width() * (f64::from(i) + 0.5) / f64::from(POINTS);
                (toward * t, profile.value(t).powi(2))
            });
            let all: Vec<(f64, f64)> = all.collect();
            let sum: f64 = all.iter().map(|(_, weight)| weight).sum();
            all.into_iter()
                .map(|(t, weight)| (t, weight / sum))
                .collect()
        };
        let [one, other] = profiles;
        Self {
            profiles: [points(one, cos), points(other, sin)],
        }
    }

    fn at(&self, frequency: f64) -> f64 {
        let of = |points: &Vec<(f64, f64)>| -> f64 {
            let terms = points
                .iter()
                .map(|(t, weight)| weight * libm::cos(TAU * frequency * t));
            terms.sum()
        };
        self.profiles.iter().map(of).product()
    }
}

/// The weights of given frequencies for finer frequencies; `None` if the given frequencies
/// do not determine all intermediate values.
fn weights(
    from: &FrequencyAxis,
    to: &FrequencyAxis,
    covariance: &WindowCovariance,
) -> Option<AxisWeights> {
    if from == to {
        return Some(None);
    }
    let count = from.count();
    let parts = (from.spacing / to.spacing).round();
    let apart: Array1<f64> = (0..to.count())
        .map(|steps| covariance.at(steps as f64 * to.spacing))
        .collect();
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the number of parts is small and odd"
    )]
    let parts = parts as usize;
    let matrix = Array2::from_shape_fn((count, count), |(i, j)| {
        apart[parts * i.abs_diff(j)] + if i == j { RIDGE } else { 0.0 }
    });
    // The given frequency i is the finer frequency number parts · i + (parts − 1)/2.
    let known = Array2::from_shape_fn((count, to.count()), |(i, finer)| {
        apart[finer.abs_diff(parts * i + parts / 2)]
    });
    let weights = solved(&matrix, &known)?;
    let explained = (&weights * &known).sum_axis(Axis(0));
    let mut between = explained
        .iter()
        .skip(parts / 2)
        .take(parts * (count - 1) + 1);
    let is_determined = between.all(|explained| *explained >= 1.0 - OPEN);
    is_determined.then(|| Some(weights.reversed_axes().as_standard_layout().into_owned()))
}

/// The product A B. The sum is written out, because matrix products of the array library
/// differ in their bits between processors.
fn product(a: ArrayView2<'_, f64>, b: ArrayView2<'_, Complex>) -> Array2<Complex> {
    let mut product = Array2::zeros((a.nrows(), b.ncols()));
    for (mut sum, factors) in product.outer_iter_mut().zip(a.outer_iter()) {
        for (row, factor) in b.outer_iter().zip(factors) {
            sum.zip_mut_with(&row, |sum, value| *sum += value * *factor);
        }
    }
    product
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_field::cis;

    const WINDOW: Window = Window {
        x: Profile::Hann(0.5),
        y: Profile::Hann(0.5),
        u: Profile::Hann(0.4),
        v: Profile::Hann(0.4),
    };

    /// The slices of a few rays, each with the weight of the window.
    fn of_rays(grid: SliceGrid) -> Slices {
        let rays = [
            [0.1, -0.2, 0.3, 0.05],
            [-0.31, 0.12, -0.11, 0.2],
            [0.02, 0.33, 0.0, -0.15],
            [0.25, 0.2, 0.2, 0.25],
        ];
        let mut slices = Slices::zeros(grid);
        for ((k, m, n), value) in slices.half.indexed_iter_mut() {
            let rho = m as f64 * grid.rho.spacing;
            let frequency = grid.frequency(k, rho, grid.nu.value(n));
            for [x, y, u, v] in rays {
                let profiles = [(WINDOW.x, x), (WINDOW.y, y), (WINDOW.u, u), (WINDOW.v, v)];
                let weight: f64 = profiles
                    .map(|(profile, t)| profile.value(t))
                    .iter()
                    .product();
                let phase: f64 = frequency.iter().zip([x, y, u, v]).map(|(f, t)| f * t).sum();
                *value += cis(-TAU * phase) * weight;
            }
        }
        slices
    }

    fn grid(spacings: [f64; 2]) -> SliceGrid {
        let [rho, nu] = spacings.map(|spacing| FrequencyAxis { half: 9, spacing });
        SliceGrid {
            azimuths: 4,
            rho,
            nu,
        }
    }

    #[test]
    fn the_window_determines_what_is_between_frequencies() {
        let coarse = of_rays(grid([1.0, 1.25]));
        let drawn = Finer::new(&coarse.grid, &WINDOW).unwrap().of(&coarse);
        let truth = of_rays(drawn.grid);
        let parts = drawn.grid.rho.count() / coarse.grid.rho.count();
        let error = |within: f64| {
            let (rho, nu) = (drawn.grid.rho, drawn.grid.nu);
            let is_inside = |m: usize, n: usize| {
                m as f64 <= within * rho.half as f64 && nu.value(n).abs() <= within * nu.max()
            };
            let (mut off, mut all) = (0.0, 0.0);
            for (((_, m, n), a), b) in drawn.half.indexed_iter().zip(&truth.half) {
                if is_inside(m, n) {
                    off += (a - b).norm_sqr();
                    all += b.norm_sqr();
                }
            }
            f64::sqrt(off / all)
        };
        // The spectrum beyond the range of frequencies is not known.
        assert!(error(1.0) < 0.06, "{}", error(1.0));
        assert!(error(0.9) < 0.02, "{}", error(0.9));
        for ((k, m, n), value) in coarse.half.indexed_iter() {
            let at = drawn.half[[k, parts * m, parts * n + parts / 2]];
            assert!((at - value).norm_sqr().sqrt() < 1e-5, "{at} for {value}"); // the ridge
        }
        let power = finer_power(&drawn, &coarse, &coarse.radial_power());
        assert!(
            (power - drawn.radial_power())
                .iter()
                .all(|off| off.abs() < 1e-12)
        );
    }

    #[test]
    fn frequencies_too_far_apart_determine_nothing() {
        assert!(Finer::new(&grid([2.5, 1.25]), &WINDOW).is_none());
    }
}
