//! Computes bandwidths of slices. A bandwidth is the frequency below which most of the power lies,
//! at the azimuth where this frequency is largest.

use etendue_field::{FrequencyAxis, SliceGrid};
use ndarray::{ArrayView1, ArrayView2, ArrayView3, Axis};

/// The default fraction of the power that lies within a bandwidth.
pub const BANDWIDTH_FRACTION: f64 = 0.95;

/// A function that returns the bandwidth of a slice along an axis: [`bandwidth_rho`] or
/// [`bandwidth_nu`].
pub type SliceBandwidth = fn(ArrayView2<'_, f64>, &SliceGrid, f64) -> Option<f64>;

/// The largest of the bandwidths at all azimuths, with its azimuth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Widest<T> {
    /// The azimuth, radians.
    pub azimuth: f64,
    /// The largest bandwidth, which is the bandwidth at this azimuth.
    pub value: T,
}

/// Returns the bandwidth of a slice along ρ: see [`bandwidth`].
#[must_use]
pub fn bandwidth_rho(power: ArrayView2<'_, f64>, grid: &SliceGrid, fraction: f64) -> Option<f64> {
    bandwidth(power.sum_axis(Axis(1)).view(), &grid.rho, fraction)
}

/// Returns the bandwidth of a slice along ν: see [`bandwidth`].
#[must_use]
pub fn bandwidth_nu(power: ArrayView2<'_, f64>, grid: &SliceGrid, fraction: f64) -> Option<f64> {
    bandwidth(power.sum_axis(Axis(0)).view(), &grid.nu, fraction)
}

/// Returns the largest bandwidth over the azimuths of a power [azimuth, ρ ≥ 0, ν]. If several
/// azimuths have the largest bandwidth, the first of them is returned.
#[must_use]
pub fn widest(
    power: ArrayView3<'_, f64>,
    grid: &SliceGrid,
    of: SliceBandwidth,
) -> Option<Widest<f64>> {
    let (slice, value) = widest_slice(power, grid, of)?;
    let azimuth = grid.azimuth(slice);
    Some(Widest { azimuth, value })
}

/// Returns the index of the slice with the largest bandwidth, and the bandwidth of this slice.
pub(crate) fn widest_slice(
    power: ArrayView3<'_, f64>,
    grid: &SliceGrid,
    of: SliceBandwidth,
) -> Option<(usize, f64)> {
    let each = power.outer_iter().enumerate().filter_map(|(k, half)| {
        let power = grid.unfold_radial(half);
        Some((k, of(power.view(), grid, BANDWIDTH_FRACTION)?))
    });
    each.reduce(|widest, next| if next.1 > widest.1 { next } else { widest })
}

/// Returns the smallest frequency B such that the power at |frequency| ≤ B is at least `fraction`
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
    if total.is_nan() || total <= 0.0 {
        return None;
    }
    let wanted = fraction * total;
    let mut inside = 0.0;
    for step in 0..=axis.half {
        // The two cells at the same distance from zero are added. The single cell at zero extends
        // to both sides of zero.
        let (power, inner, width) = match step {
            0 => (marginal[axis.half], 0.0, 0.5),
            _ => (
                marginal[axis.half - step] + marginal[axis.half + step],
                step as f64 - 0.5,
                1.0,
            ),
        };
        if inside + power >= wanted {
            return Some((inner + width * (wanted - inside) / power) * axis.spacing);
        }
        inside += power;
    }
    // The loop ends without a result only because of rounding errors.
    Some(axis.max() + 0.5 * axis.spacing)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::{Array1, Array2, Array3, arr1};
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
        let rho = bandwidth_rho(power.view(), &grid, 0.95).unwrap();
        let nu = bandwidth_nu(power.view(), &grid, 0.95).unwrap();
        assert!((rho - 1.386 * 0.8).abs() < 0.02, "{rho}"); // curvature within a cell of 0.3
        assert!((nu - 1.386).abs() < 0.02, "{nu}"); // curvature within a cell of 0.25
    }

    /// Returns ∫ cos²(π t/2) e^(−2πi f t) dt over |t| < 1: a Hann window of half-width 1.
    fn hann(f: f64) -> f64 {
        let sinc = |x: f64| match x.abs() < 1e-9 {
            true => 1.0,
            false => libm::sin(PI * x) / (PI * x),
        };
        sinc(2.0 * f) + 0.5 * (sinc(2.0 * f - 1.0) + sinc(2.0 * f + 1.0))
    }

    /// Returns the power along one axis of a Hann window alone, or of a sine of contrast 1
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
        let found = widest(power.view(), &grid, bandwidth_nu).unwrap();
        assert!((found.azimuth - PI / 2.0).abs() < 1e-12, "{found:?}"); // rounding
        let alone = bandwidth(
            seen(Some(3.0), &grid.nu).view(),
            &grid.nu,
            BANDWIDTH_FRACTION,
        );
        assert_eq!(Some(found.value), alone);
    }
}
