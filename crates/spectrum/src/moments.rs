//! Computes statistics of a measured or predicted power spectrum [ρ, ν].

use etendue_field::{Profile, SliceGrid, Window};
use ndarray::{ArrayView2, Axis};

/// The second moment Σ P ρᵐ νⁿ / Σ P of the power P, where `powers` is [m, n] with m + n
/// = 2.
///
/// The sum runs over the frequencies of the grid. If the field has an edge, the moment grows
/// without bound with the grid, and a [`bandwidth`](crate::bandwidth::bandwidth) is more
/// meaningful. The unit is (cycles per metre)^m times (cycles per unit slope)^n. Returns `None` if
/// Σ P is not positive.
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

/// The slope dν/dρ of the line along which the power lies, by least squares: Σ P ρ ν / Σ
/// P ρ².
///
/// Travel by the distance d moves power from (ρ, 0) to (ρ, −d ρ), so the slope is near −d. Unit:
/// metres. Returns `None` if Σ P ρ² is not positive.
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

/// H = Σ_{|ρ| > cut} P(ρ, 0) / Σ P(ρ, 0). In the spectrum at ν = 0, H is the share of the
/// energy at frequencies above a cut.
///
/// On a plane where light leaves a diffuse surface, the field is constant in slope, and the
/// spectrum at ν = 0 is the spectrum of the windowed irradiance. On such a plane, H distinguishes a
/// sharp shadow from a smooth shadow (Durand et al. 2005, Fig. 9). Returns `None` if Σ P(ρ, 0) is
/// not positive.
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

/// The share of the power that lies in the wedge of blockers whose distances from the plane
/// are in `[nearest, farthest]`, in metres.
///
/// A blocker at the distance d has its frequencies on the line ν = −d ρ (Durand et al. 2005,
/// section 3.2; Egan et al. 2009). The window blurs the lines of blockers. A frequency therefore
/// counts as inside the wedge if its distance from the wedge is within the main lobe of a Hann
/// window, 1/half-width along each axis. Frequencies within the main lobe around zero are left out,
/// because they contain the mean of the light. Returns `None` if the sum of the power over all
/// other frequencies is not positive.
#[must_use]
pub fn wedge_share(
    power: ArrayView2<'_, f64>,
    grid: &SliceGrid,
    window: &Window,
    distances: [f64; 2],
) -> Option<f64> {
    let lobe = |a: &Profile, b: &Profile| 1.0 / a.half_width().min(b.half_width());
    let [rho_lobe, nu_lobe] = [lobe(&window.x, &window.y), lobe(&window.u, &window.v)];
    let (mut inside, mut all) = (0.0, 0.0);
    for ((i, j), p) in power.indexed_iter() {
        let (rho, nu) = (grid.rho.value(i), grid.nu.value(j));
        if rho.abs() < rho_lobe && nu.abs() < nu_lobe {
            continue;
        }
        all += p;
        let from_lines = distances.map(|d| nu + d * rho);
        let is_near = |(line, d): (f64, f64)| line.abs() < nu_lobe + d * rho_lobe;
        let is_between = (from_lines[0] < 0.0) != (from_lines[1] < 0.0);
        if is_between || from_lines.into_iter().zip(distances).any(is_near) {
            inside += p;
        }
    }
    (all > 0.0).then(|| inside / all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_field::FrequencyAxis;
    use ndarray::Array2;

    fn grid() -> SliceGrid {
        let axis = |half, spacing| FrequencyAxis { half, spacing };
        SliceGrid {
            azimuths: 1,
            rho: axis(10, 0.3),
            nu: axis(40, 0.25),
        }
    }

    /// The power of a Gaussian ridge along ν = `slope` ρ.
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
        // The mean of ρ² is 0.8²/2. For a given ρ, ν has the mean ρ/2 and the variance ½. The tails
        // outside the grid are below e^-14.
        let square = 0.5 * 0.8 * 0.8;
        assert!((moment([2, 0]) - square).abs() < 1e-4);
        assert!((moment([1, 1]) - 0.5 * square).abs() < 1e-4);
        assert!((moment([0, 2]) - 0.5 - 0.25 * square).abs() < 1e-4);
    }

    #[test]
    fn the_slope_of_a_ridge_is_found() {
        for slope in [-2.0, -0.5, 0.0, 1.3] {
            let found = shear_slope(ridge(slope).view(), &grid()).unwrap();
            // The ridge leaves the grid in ν at the ends of the ρ axis, where the height of the
            // ridge is e^-14.
            assert!((found - slope).abs() < 1e-5, "{found}");
        }
        assert!(shear_slope((-ridge(1.0)).view(), &grid()).is_none());
        assert!(shear_slope(Array2::zeros((21, 81)).view(), &grid()).is_none());
    }

    /// Two blockers are 0.5 m and 1 m away, and their lines have equal power. A third blocker is 5
    /// m away, and its line has as much power as the other two lines together.
    #[test]
    fn lines_of_a_wedge_are_inside() {
        let grid = grid();
        let profile = Profile::Hann(2.0);
        let window = Window {
            x: profile,
            y: profile,
            u: profile,
            v: profile,
        };
        let lines = ridge(-0.5) + ridge(-1.0) + ridge(-5.0) * 2.0;
        let share = |distances| wedge_share(lines.view(), &grid, &window, distances).unwrap();
        let beyond = |slope| {
            let line = ridge(slope);
            let outside = line.indexed_iter().filter(|((i, j), _)| {
                let (rho, nu) = (grid.rho.value(*i).abs(), grid.nu.value(*j).abs());
                rho >= 0.5 || nu >= 0.5
            });
            outside.map(|(_, p)| p).sum::<f64>()
        };
        let all = beyond(-0.5) + beyond(-1.0) + 2.0 * beyond(-5.0);
        // For each of the two near blockers, at most e^(−1) of the power is beyond the main lobe,
        // whose half-width is 0.5 /m. Near zero frequency, the line of the far blocker is also
        // within the main lobe.
        let alone = (beyond(-0.5) + beyond(-1.0)) / all;
        assert!(share([0.5, 1.0]) > 0.9 * alone && share([0.5, 1.0]) < 0.8);
        assert!(share([0.5, 5.0]) > 0.97);
    }

    #[test]
    fn share_above_a_cut_counts_the_row_without_slope() {
        // Eleven of the 21 frequencies i · 0.3 have |i| ≤ 5. Only the column at ν = 0 counts.
        let mut power = Array2::zeros((21, 81));
        power.index_axis_mut(Axis(1), 40).fill(2.0);
        power.index_axis_mut(Axis(1), 41).fill(100.0);
        let share = high_frequency_share(power.view(), &grid(), 1.6).unwrap();
        assert!((share - 10.0 / 21.0).abs() < 1e-15); // rounding
        assert!(high_frequency_share(Array2::zeros((21, 81)).view(), &grid(), 1.0).is_none());
    }
}
