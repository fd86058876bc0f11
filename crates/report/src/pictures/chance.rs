//! Computes how many cells in the picture of a difference exceed the range of colors by chance.

use etendue_compare::PlaneComparison;
use etendue_store::arrays::radial_z;
use ndarray::Axis;

/// The difference at which the range of colors ends, in standard deviations.
const BEYOND: f64 = 4.0;

/// Three numbers of frequencies. The first counts the independent frequencies. The second counts
/// those with a difference above 4 σ. The third is the value that the second would have on average
/// if there were only noise.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Outliers {
    cells: usize,
    found: usize,
    expected: f64,
}

impl Outliers {
    /// Power is not normally distributed. Without light, power is the mean of one exponential
    /// variable per azimuth, so large values are more frequent than for a normal variable. The
    /// function uses a shifted gamma variable with the same first three moments. Its distribution
    /// is exact if all azimuths have the same noise.
    pub(super) fn of(plane: &PlaneComparison) -> Self {
        let grid = plane.measured.grid;
        let z = radial_z(plane);
        let mut all = Self::default();
        for ((m, n), _) in plane.sigma.index_axis(Axis(0), 0).indexed_iter() {
            let z = z[[grid.rho.half + m, n]];
            if !grid.is_independent(m, n) || !z.is_finite() {
                continue;
            }
            let (mut second, mut third) = (0.0, 0.0);
            for azimuth in 0..grid.azimuths {
                let power = plane.predicted.half[[azimuth, m, n]].norm_sqr();
                let noise = plane.sigma[[azimuth, m, n]].powi(2);
                second += noise * (2.0 * power + noise);
                third += noise * noise * (6.0 * power + 2.0 * noise);
            }
            all.cells += 1;
            all.found += usize::from(z.abs() > BEYOND);
            all.expected += beyond(third / libm::pow(second, 1.5));
        }
        all
    }

    /// A sentence that states these three numbers.
    pub(super) fn words(&self) -> String {
        let Self {
            cells,
            found,
            expected,
        } = self;
        format!(
            "{found} of {cells} frequencies differ by more than 4 *σ*. Chance alone would give {expected:.1} such frequencies on average. The noise of neighbouring frequencies is correlated."
        )
    }
}

/// The probability that the modulus of a shifted gamma variable exceeds 4. The variable has
/// mean 0, variance 1 and this skewness. The function uses the approximation of Wilson and Hilferty
/// (1931).
fn beyond(skewness: f64) -> f64 {
    let shape = 4.0 / skewness.max(1e-6).powi(2);
    let tail = |z: f64| {
        let root = libm::cbrt((1.0 + z / shape.sqrt()).max(0.0));
        let normal = (root - 1.0 + 1.0 / (9.0 * shape)) * (9.0 * shape).sqrt();
        0.5 * libm::erfc(normal / std::f64::consts::SQRT_2)
    };
    tail(BEYOND) + (1.0 - tail(-BEYOND))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean of 8 exponential variables exceeds 1 + 4/√8 with probability Σ_(k<8) xᵏ e⁻ˣ/k!, x =
    /// 8 + 4 √8. A normal variable exceeds 4 in modulus with probability 6.3·10⁻⁵.
    #[test]
    fn power_is_beyond_four_more_often_than_a_normal_variable() {
        let x = 8.0 + 4.0 * 8.0_f64.sqrt();
        let terms = (1..8).scan(1.0, |term, k| {
            *term *= x / f64::from(k);
            Some(*term)
        });
        let truth = libm::exp(-x) * (1.0 + terms.sum::<f64>());
        let found = beyond(2.0 / 8.0_f64.sqrt());
        assert!((found / truth - 1.0).abs() < 0.06, "{found} for {truth}"); // the approximation
        assert!((beyond(0.0) / 6.334e-5 - 1.0).abs() < 0.01);
    }
}
