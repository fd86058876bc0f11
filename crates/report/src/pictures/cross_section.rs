//! Computes the light field over (y, v) from its spectrum.

use etendue_compare::PlaneComparison;
use etendue_field::{Complex, FrequencyAxis, SliceGrid, Slices, cis};
use ndarray::{Array2, ArrayView1};
use std::f64::consts::TAU;

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

/// The light field over (y, v) in 64 × 64 cells that fill ± `half_widths`. The field is
/// multiplied by the window and integrated over x and u. Within the range of the frequencies, its
/// spectrum is the slice at azimuth 90°. Returns `None` if there is no slice at azimuth 90°.
pub fn across(slices: &Slices, half_widths: [f64; 2]) -> Option<Array2<f64>> {
    const CELLS: usize = 64;
    let SliceGrid { azimuths, rho, nu } = &slices.grid;
    if azimuths % 2 != 0 {
        return None;
    }
    let full = slices.full();
    let slice = full.index_axis(ndarray::Axis(0), azimuths / 2);
    // The factors e^(2πi Ω z) dΩ of the transform, [cell, frequency].
    let waves = |axis: &FrequencyAxis, half: f64| {
        let values = axis.values();
        Array2::from_shape_fn((CELLS, values.len()), |(cell, i)| {
            let z = half * ((2 * cell + 1) as f64 / CELLS as f64 - 1.0);
            cis(TAU * values[i] * z) * axis.spacing
        })
    };
    let [y, v] = [waves(rho, half_widths[0]), waves(nu, half_widths[1])];
    // The sum is written out, because matrix products of the array library differ in their bits
    // between processors.
    let sum = |a: ArrayView1<'_, Complex>, b: ArrayView1<'_, Complex>| {
        let terms = a.iter().zip(b).map(|(a, b)| a * b);
        terms.fold(Complex::ZERO, |sum, term| sum + term)
    };
    let over_y =
        Array2::from_shape_fn((CELLS, nu.count()), |(i, k)| sum(y.row(i), slice.column(k)));
    let values = Array2::from_shape_fn((CELLS, CELLS), |(i, j)| sum(over_y.row(i), v.row(j)).re);
    Some(values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

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
