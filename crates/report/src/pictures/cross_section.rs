//! Computes the light field over (y, v) from its spectrum.

use etendue_compare::PlaneComparison;
use etendue_field::Slices;
use ndarray::Array2;

/// Checks whether the light in (y, v) differs from the light in (x, u). The function compares the
/// slices at azimuths 0 and 90°.
pub(super) fn differs_across(plane: &PlaneComparison) -> bool {
    const SHARE: f64 = 0.3;
    let slices = plane.predicted.half.view();
    let [one, other] = [0, plane.predicted.grid.azimuths / 2]
        .map(|azimuth| slices.index_axis(ndarray::Axis(0), azimuth));
    let power = |terms: &mut dyn Iterator<Item = f64>| terms.sum::<f64>().sqrt();
    let apart = power(&mut one.iter().zip(other).map(|(a, b)| (a - b).norm_sqr()));
    apart > SHARE * power(&mut one.iter().map(|a| a.norm_sqr()))
}

/// The light field over (y, v) in 64 × 64 cells that fill ± `half_widths`. Returns `None` if there
/// is no slice at azimuth 90°.
pub fn across(slices: &Slices, half_widths: [f64; 2]) -> Option<Array2<f64>> {
    let azimuths = slices.grid.azimuths;
    let has_slice = azimuths.is_multiple_of(2);
    has_slice.then(|| slices.light_field(azimuths / 2, 64, half_widths))
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_field::{FrequencyAxis, SliceGrid, cis};
    use std::f64::consts::{PI, TAU};

    /// Reconstructs an off-centre Gaussian from its transform.
    #[test]
    fn the_light_field_over_y_and_v_is_that_of_its_slice() {
        let axis = |half, spacing| FrequencyAxis { half, spacing };
        let grid = SliceGrid {
            azimuths: 2,
            rho: axis(24, 0.5),
            nu: axis(20, 0.4),
        };
        let ([a, b], middle) = ([0.3, 0.4], 0.2);
        let mut slices = Slices::zeros(grid);
        for i in 0..=grid.rho.half {
            for (j, nu) in grid.nu.values().into_iter().enumerate() {
                let rho = i as f64 * grid.rho.spacing;
                let size = a * b * libm::exp(-PI * (a * a * rho * rho + b * b * nu * nu));
                slices.half[[1, i, j]] = cis(-TAU * rho * middle) * size;
            }
        }
        let values = across(&slices, [0.8, 1.0]).unwrap();
        for ((i, j), value) in values.indexed_iter() {
            let at = |cell: usize, half: f64| half * ((2 * cell + 1) as f64 / 64.0 - 1.0);
            let (y, v) = (at(i, 0.8), at(j, 1.0));
            let truth = libm::exp(-PI * (((y - middle) / a).powi(2) + (v / b).powi(2)));
            assert!(
                (value - truth).abs() < 1e-6,
                "{value} for {truth} at ({y}, {v})"
            ); // beyond the grid is 1e-9
        }
        assert!(
            across(
                &Slices::zeros(SliceGrid {
                    azimuths: 3,
                    ..grid
                }),
                [1.0; 2]
            )
            .is_none()
        );
    }
}
