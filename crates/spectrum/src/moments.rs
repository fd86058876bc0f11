//! Numbers read off a power spectrum [ρ, ν], measured or predicted alike.

use etendue_field::{FrequencyAxis, SliceGrid};
use ndarray::{ArrayView1, ArrayView2, Axis};

/// The fraction of the power that a bandwidth holds, unless another is asked for.
pub const BANDWIDTH_FRACTION: f64 = 0.95;

/// A second moment of the power, Σ P ρᵐ νⁿ / Σ P with m + n = 2, `powers` being [m, n].
///
/// Over the frequencies of the grid: where the field has an edge the sum grows without end with them, and a [`bandwidth`] says more.
/// Unit: cycles per metre to the m times cycles per unit slope to the n. `None` when Σ P is not positive.
#[must_use]
pub fn second_moment(
    power: ArrayView2<'_, f64>,
    grid: &SliceGrid,
    powers: [i32; 2],
) -> Option<f64> {
    let (mut sum, mut all) = (0.0, 0.0);
    for ((i, j), p) in power.indexed_iter() {
        all += p;
        sum += p * grid.rho.value(i).powi(powers[0]) * grid.nu.value(j).powi(powers[1]);
    }
    (all > 0.0).then(|| sum / all)
}

/// The slope dν/dρ along which the power lies, by least squares: Σ P ρ ν / Σ P ρ².
///
/// Travel by d moves power from (ρ, 0) to (ρ, −d ρ), so the slope is near −d. Unit: metres. `None` when Σ P ρ² is not positive.
#[must_use]
pub fn shear_slope(power: ArrayView2<'_, f64>, grid: &SliceGrid) -> Option<f64> {
    let (mut along, mut square) = (0.0, 0.0);
    for ((i, j), p) in power.indexed_iter() {
        let rho = grid.rho.value(i);
        along += p * rho * grid.nu.value(j);
        square += p * rho * rho;
    }
    (square > 0.0).then(|| along / square)
}

/// The bandwidth in ρ: see [`bandwidth`].
#[must_use]
pub fn bandwidth_rho(power: ArrayView2<'_, f64>, grid: &SliceGrid, fraction: f64) -> Option<f64> {
    bandwidth(power.sum_axis(Axis(1)).view(), &grid.rho, fraction)
}

/// The bandwidth in ν: see [`bandwidth`].
#[must_use]
pub fn bandwidth_nu(power: ArrayView2<'_, f64>, grid: &SliceGrid, fraction: f64) -> Option<f64> {
    bandwidth(power.sum_axis(Axis(0)).view(), &grid.nu, fraction)
}

/// The smallest B for which the power at |frequency| ≤ B is at least `fraction` of the total.
///
/// `marginal` is the power along `axis`, summed over the other one. Between the frequencies of the axis the
/// power inside grows linearly with B; what lies at zero is inside from B = 0. Unit: that of the axis.
/// `None` when the total is not positive.
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
    let mut inside = marginal[axis.half];
    if inside >= wanted {
        return Some(0.0);
    }
    for step in 1..=axis.half {
        let next = inside + marginal[axis.half - step] + marginal[axis.half + step];
        if next >= wanted {
            let part = (wanted - inside) / (next - inside);
            return Some(((step - 1) as f64 + part) * axis.spacing);
        }
        inside = next;
    }
    // Only rounding can keep the whole from reaching a fraction of it.
    Some(axis.max())
}

/// H, the share of energy above a cut in the spectrum at ν = 0: Σ_{|ρ| > cut} P(ρ, 0) / Σ P(ρ, 0).
///
/// On a plane that light leaves diffusely, the field is constant in slope and this is the spectrum of the windowed
/// irradiance: H tells a sharp shadow from a smooth one (Durand et al. 2005, Fig. 9). `None` when the sum is not positive.
#[must_use]
pub fn high_frequency_share(power: ArrayView2<'_, f64>, grid: &SliceGrid, cut: f64) -> Option<f64> {
    let (mut high, mut all) = (0.0, 0.0);
    for (i, p) in power.index_axis(Axis(1), grid.nu.half).iter().enumerate() {
        all += p;
        if grid.rho.value(i).abs() > cut {
            high += p;
        }
    }
    (all > 0.0).then(|| high / all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::{Array1, Array2, arr1};

    fn grid() -> SliceGrid {
        let axis = |half, spacing| FrequencyAxis { half, spacing };
        SliceGrid {
            azimuths: 1,
            rho: axis(10, 0.3),
            nu: axis(40, 0.25),
        }
    }

    /// A Gaussian ridge along ν = `slope` ρ.
    fn ridge(slope: f64) -> Array2<f64> {
        let grid = grid();
        Array2::from_shape_fn((grid.rho.count(), grid.nu.count()), |(i, j)| {
            let (rho, nu) = (grid.rho.value(i), grid.nu.value(j));
            libm::exp(-(nu - slope * rho).powi(2) - (rho / 0.8).powi(2))
        })
    }

    #[test]
    fn second_moments_of_a_ridge_are_those_of_its_gaussian() {
        let grid = grid();
        let ridge = ridge(0.5);
        let moment = |powers| second_moment(ridge.view(), &grid, powers).unwrap();
        // ρ² has the mean 0.8²/2, ν given ρ the mean ρ/2 and the variance ½; the tails off the grid are below e^-14.
        let square = 0.5 * 0.8 * 0.8;
        assert!((moment([2, 0]) - square).abs() < 1e-4);
        assert!((moment([1, 1]) - 0.5 * square).abs() < 1e-4);
        assert!((moment([0, 2]) - 0.5 - 0.25 * square).abs() < 1e-4);
    }

    #[test]
    fn the_slope_of_a_ridge_is_found() {
        for slope in [-2.0, -0.5, 0.0, 1.3] {
            let found = shear_slope(ridge(slope).view(), &grid()).unwrap();
            // The ridge is e^-14 high at the ends of the ρ axis, where its ν would leave the grid.
            assert!((found - slope).abs() < 1e-5, "{found}");
        }
        assert!(shear_slope((-ridge(1.0)).view(), &grid()).is_none());
        assert!(shear_slope(Array2::zeros((21, 81)).view(), &grid()).is_none());
    }

    #[test]
    fn bandwidths_of_known_powers() {
        let axis = grid().nu;
        let flat = Array1::ones(81);
        // |frequency| ≤ j steps holds 2j + 1 of 81: 0.95 · 81 = 76.95 is reached at j = 37.975.
        let found = bandwidth(flat.view(), &axis, 0.95).unwrap();
        assert!((found - 37.975 * 0.25).abs() < 1e-12); // rounding

        let three = FrequencyAxis {
            half: 1,
            spacing: 2.0,
        };
        let zero = bandwidth(arr1(&[0.0, 3.0, 0.1]).view(), &three, 0.95);
        assert_eq!(zero, Some(0.0));
        assert!(bandwidth(arr1(&[1.0, -3.0, 1.0]).view(), &three, 0.95).is_none());
        assert_eq!(
            bandwidth(arr1(&[1.0, 0.0, 1.0]).view(), &three, 1.0),
            Some(2.0)
        );
    }

    #[test]
    fn share_above_a_cut_counts_the_row_without_slope() {
        // Eleven of the 21 frequencies i · 0.3 have |i| ≤ 5; only the column at ν = 0 counts.
        let mut power = Array2::zeros((21, 81));
        power.index_axis_mut(Axis(1), 40).fill(2.0);
        power.index_axis_mut(Axis(1), 41).fill(100.0);
        let share = high_frequency_share(power.view(), &grid(), 1.6).unwrap();
        assert!((share - 10.0 / 21.0).abs() < 1e-15); // rounding
        assert!(high_frequency_share(Array2::zeros((21, 81)).view(), &grid(), 1.0).is_none());
    }

    #[test]
    fn both_axes_of_a_ridge() {
        // Without shear, Gaussians exp(−t²/s²) with s = 0.8 and 1: erf(B/s) = 0.95 at B = 1.386 s.
        let power = ridge(0.0);
        let rho = bandwidth_rho(power.view(), &grid(), 0.95).unwrap();
        let nu = bandwidth_nu(power.view(), &grid(), 0.95).unwrap();
        // A sum over |ν| ≤ B reaches half a step beyond B: B is smaller than the integral's by that.
        assert!((rho + 0.15 - 1.386 * 0.8).abs() < 0.02, "{rho}"); // curvature within a step of 0.3
        assert!((nu + 0.125 - 1.386).abs() < 0.02, "{nu}"); // the same for 0.25
    }
}
