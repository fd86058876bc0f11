//! Computes bandwidths of slices. A bandwidth is the frequency below which most of the power lies,
//! at the azimuth where this frequency is largest.

use crate::jackknife::Uncertain;
use etendue_field::{FrequencyAxis, SliceGrid};
use ndarray::{Array1, ArrayView1, ArrayView2, ArrayView3, Axis};

/// The default fraction of the power that lies within a bandwidth.
pub const BANDWIDTH_FRACTION: f64 = 0.95;

/// The axis of a slice along which a bandwidth is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    /// Position.
    Rho,
    /// Slope.
    Nu,
}

impl Along {
    /// A slice's power [ρ, ν] summed onto the axis, and the axis.
    fn marginal(
        self,
        power: ArrayView2<'_, f64>,
        grid: &SliceGrid,
    ) -> (Array1<f64>, FrequencyAxis) {
        match self {
            Self::Rho => (power.sum_axis(Axis(1)), grid.rho),
            Self::Nu => (power.sum_axis(Axis(0)), grid.nu),
        }
    }

    /// The bandwidth of the power of a slice [ρ, ν]: see [`bandwidth`].
    #[must_use]
    pub fn bandwidth(self, power: ArrayView2<'_, f64>, grid: &SliceGrid) -> Option<f64> {
        let (marginal, axis) = self.marginal(power, grid);
        bandwidth(marginal.view(), &axis, BANDWIDTH_FRACTION)
    }

    /// What the power of a slice [ρ, ν] within each cell end lacks to [`BANDWIDTH_FRACTION`]
    /// of the whole (see [`missing`]), and last what the power within the frequency `bound` lacks.
    pub(crate) fn missing(
        self,
        power: ArrayView2<'_, f64>,
        grid: &SliceGrid,
        bound: f64,
    ) -> Array1<f64> {
        let (marginal, axis) = self.marginal(power, grid);
        let mut all = missing(marginal.view(), &axis, BANDWIDTH_FRACTION);
        let at = bound / axis.spacing;
        let after = (1..all.len() - 1).find(|i| cell_end(*i) >= at);
        let after = after.unwrap_or(all.len() - 1);
        let [start, end] = [after - 1, after].map(cell_end);
        let share = (at - start) / (end - start);
        all.push(all[after - 1] + share * (all[after] - all[after - 1]));
        all.into()
    }

    /// A bandwidth with its standard error. `missing` is what [`Along::missing`] returns for
    /// it, and `errors` are the standard errors of these numbers.
    ///
    /// The error is found as that of a quantile (Woodruff 1952): it is the distance to the farther of
    /// the frequencies at which the enclosed power lacks one standard error, and has one too many.
    /// Where noise is a large part of the power, the enclosed power does not grow steadily. Then the
    /// error is at least half of the distance to each cell end where what is lacking is within two
    /// standard errors of zero.
    pub(crate) fn with_error(
        self,
        value: f64,
        [missing, errors]: [&[f64]; 2],
        grid: &SliceGrid,
    ) -> Uncertain {
        let spacing = match self {
            Self::Rho => grid.rho.spacing,
            Self::Nu => grid.nu.spacing,
        };
        let away = |end: f64| (end * spacing - value).abs();
        let [cells @ .., _] = missing else {
            unreachable!("the last number belongs to the bound")
        };
        let error = errors[cells.len()];
        let near = [error, -error].map(|level| away(crossing(cells, level)));
        let ends = cells.iter().zip(errors).enumerate();
        let undecided = ends.filter(|(_, (lack, error))| lack.abs() <= 2.0 * **error);
        let undecided = undecided.map(|(i, _)| 0.5 * away(cell_end(i)));
        let error = undecided.chain(near).fold(0.0, f64::max);
        Uncertain { value, error }
    }
}

/// The largest of the bandwidths at all azimuths, with its azimuth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Widest<T> {
    /// The azimuth, radians.
    pub azimuth: f64,
    /// The largest bandwidth, which is the bandwidth at this azimuth.
    pub value: T,
}

/// The largest bandwidth over the azimuths of a power [azimuth, ρ ≥ 0, ν]. If several
/// azimuths have the largest bandwidth, the first of them is returned.
#[must_use]
pub fn widest(power: ArrayView3<'_, f64>, grid: &SliceGrid, along: Along) -> Option<Widest<f64>> {
    let (slice, value) = widest_slice(power, grid, along)?;
    let azimuth = grid.azimuth(slice);
    Some(Widest { azimuth, value })
}

/// The index of the slice with the largest bandwidth, and the bandwidth of this slice.
pub(crate) fn widest_slice(
    power: ArrayView3<'_, f64>,
    grid: &SliceGrid,
    along: Along,
) -> Option<(usize, f64)> {
    let each = power.outer_iter().enumerate().filter_map(|(k, half)| {
        let power = grid.unfold_radial(half);
        Some((k, along.bandwidth(power.view(), grid)?))
    });
    each.reduce(|widest, next| if next.1 > widest.1 { next } else { widest })
}

/// The smallest frequency B such that the power at |frequency| ≤ B is at least `fraction`
/// times the total power.
///
/// `marginal` is the power along `axis`, summed over the other axis. The power at each frequency is
/// spread uniformly over a cell, which extends half a step to either side of the frequency.
/// Therefore the enclosed power grows linearly with B within a cell. B has the unit of the axis.
/// Returns `None` if the total power is not positive.
#[must_use]
pub fn bandwidth(
    marginal: ArrayView1<'_, f64>,
    axis: &FrequencyAxis,
    fraction: f64,
) -> Option<f64> {
    let total = marginal.sum();
    (total > 0.0).then(|| crossing(&missing(marginal, axis, fraction), 0.0) * axis.spacing)
}

/// What the power within each cell end lacks to `fraction` of the whole power. The first
/// number belongs to frequency zero. The two cells at the same distance from zero are added; the
/// single cell at zero extends to both sides of zero.
fn missing(marginal: ArrayView1<'_, f64>, axis: &FrequencyAxis, fraction: f64) -> Vec<f64> {
    let wanted = fraction * marginal.sum();
    let mut inside = 0.0;
    let powers = (0..=axis.half).map(|step| match step {
        0 => marginal[axis.half],
        _ => marginal[axis.half - step] + marginal[axis.half + step],
    });
    let within = powers.map(|power| {
        inside += power;
        wanted - inside
    });
    std::iter::once(wanted).chain(within).collect()
}

/// The frequency at which cell `i` begins, or at which the cell before it ends, in steps of
/// the axis.
fn cell_end(i: usize) -> f64 {
    if i == 0 { 0.0 } else { i as f64 - 0.5 }
}

/// The lowest frequency, in steps of the axis, at which the enclosed power lacks `level` or
/// less.
fn crossing(missing: &[f64], level: f64) -> f64 {
    let Some(i) = missing.iter().position(|lack| *lack <= level) else {
        return cell_end(missing.len() - 1);
    };
    if i == 0 {
        return 0.0;
    }
    let [before, after] = [i - 1, i].map(cell_end);
    let share = (missing[i - 1] - level) / (missing[i - 1] - missing[i]);
    before + share * (after - before)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::{Array2, Array3, arr1};
    use std::f64::consts::PI;

    fn axis(half: usize, spacing: f64) -> FrequencyAxis {
        FrequencyAxis { half, spacing }
    }

    #[test]
    fn bandwidths_of_known_powers() {
        // The power is uniform over 81 cells of width 0.25, and 0.95 of it is within the
        // bandwidth.
        let flat = bandwidth(Array1::ones(81).view(), &axis(40, 0.25), 0.95).unwrap();
        assert!((flat - 0.95 * 81.0 * 0.25 / 2.0).abs() < 1e-12); // rounding
        let of =
            |powers: [f64; 3], fraction| bandwidth(arr1(&powers).view(), &axis(1, 2.0), fraction);
        // The cell at zero covers −1 to 1 and has all of the power; half of it is within ±0.5.
        assert_eq!(of([0.0, 3.0, 0.0], 0.5), Some(0.5));
        assert_eq!(of([1.0, 0.0, 1.0], 0.5), Some(2.0));
        assert_eq!(of([1.0, 0.0, 1.0], 1.0), Some(3.0));
        assert!(of([1.0, -3.0, 1.0], 0.95).is_none());
    }

    #[test]
    fn gaussians_along_both_axes() {
        let grid = SliceGrid {
            azimuths: 1,
            rho: axis(10, 0.3),
            nu: axis(40, 0.25),
        };
        let power = Array2::from_shape_fn((21, 81), |(i, j)| {
            let (rho, nu) = (grid.rho.value(i), grid.nu.value(j));
            libm::exp(-(nu * nu) - (rho / 0.8).powi(2))
        });
        // The power is exp(−t²/s²) with s = 0.8 and 1, and erf(B/s) = 0.95 at B = 1.386 s.
        let rho = Along::Rho.bandwidth(power.view(), &grid).unwrap();
        let nu = Along::Nu.bandwidth(power.view(), &grid).unwrap();
        assert!((rho - 1.386 * 0.8).abs() < 0.02, "{rho}"); // curvature within a cell of 0.3
        assert!((nu - 1.386).abs() < 0.02, "{nu}"); // curvature within a cell of 0.25
    }

    /// ∫ cos²(π t/2) e^(−2πi f t) dt over |t| < 1: a Hann window of half-width 1.
    fn hann(f: f64) -> f64 {
        let sinc = |x: f64| match x.abs() < 1e-9 {
            true => 1.0,
            false => libm::sin(PI * x) / (PI * x),
        };
        sinc(2.0 * f) + 0.5 * (sinc(2.0 * f - 1.0) + sinc(2.0 * f + 1.0))
    }

    /// The power along one axis of a Hann window alone, or of a sine of contrast 1
    /// multiplied by the window.
    fn seen(frequency: Option<f64>, axis: &FrequencyAxis) -> Array1<f64> {
        let values = axis.values().into_iter();
        let sides = |f: f64| frequency.map_or(0.0, |at| 0.5 * (hann(f - at) + hann(f + at)));
        values.map(|f| (hann(f) + sides(f)).powi(2)).collect()
    }

    #[test]
    fn a_window_alone_has_its_own_bandwidth() {
        // The midpoint rule with 4·10⁴ points up to 20 gives the bandwidth 0.55722 for a half-width
        // of 1. For a half-width of 0.09105, the bandwidth is 6.12.
        for (spacing, error) in [(0.02, 1e-3), (0.125, 4e-3)] {
            let axis = axis(100, spacing);
            let found = bandwidth(seen(None, &axis).view(), &axis, 0.95).unwrap();
            // The tolerance allows for the curvature of the power within a cell.
            assert!((found - 0.557_22).abs() < error, "{spacing}: {found}");
        }
    }

    #[test]
    fn a_bandwidth_is_not_below_the_signal() {
        // A third of the power is near the frequency of the sine, and no more than a twentieth of
        // the total power is outside the bandwidth.
        for frequency in [1.5, 3.04, 4.7] {
            let axis = axis(24, 0.25);
            let found = bandwidth(seen(Some(frequency), &axis).view(), &axis, 0.95).unwrap();
            let exact = FrequencyAxis {
                half: 2400,
                spacing: 0.0025,
            };
            let exact = bandwidth(seen(Some(frequency), &exact).view(), &exact, 0.95).unwrap();
            assert!(found > frequency, "{found}");
            assert!((found - exact).abs() < 0.02, "{found} {exact}"); // the curvature of the power within a cell
        }
    }

    #[test]
    fn the_widest_azimuth_counts() {
        let grid = SliceGrid {
            azimuths: 4,
            rho: axis(0, 1.0),
            nu: axis(24, 0.25),
        };
        let mut power = Array3::zeros(grid.half_shape());
        for (k, mut slice) in power.outer_iter_mut().enumerate() {
            let frequency = (k == 2).then_some(3.0);
            slice.row_mut(0).assign(&seen(frequency, &grid.nu));
        }
        let found = widest(power.view(), &grid, Along::Nu).unwrap();
        assert!((found.azimuth - PI / 2.0).abs() < 1e-12, "{found:?}"); // rounding
        let alone = bandwidth(
            seen(Some(3.0), &grid.nu).view(),
            &grid.nu,
            BANDWIDTH_FRACTION,
        );
        assert_eq!(Some(found.value), alone);
    }
}
