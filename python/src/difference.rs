//! The test of two spectra of the same light.

use etendue_compare::{Residuals, Sample, TwoSamples};
use etendue_field::{Complex, FrequencyAxis, SliceGrid};
use ndarray::{Array3, ArrayView3, Axis};
use numpy::{PyReadonlyArray3, PyReadonlyArray4};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// A measured spectrum: the slices and their standard errors [azimuth, ρ, ν], the effective number
/// of independent numbers in their noise, and the number of batches.
type Measured<'py> = (
    PyReadonlyArray3<'py, Complex>,
    PyReadonlyArray3<'py, f64>,
    Option<f64>,
    usize,
);

/// Tests whether two spectra differ by more than noise. `pairs` are the batches of both, [batch,
/// azimuth, ρ ≥ 0, ν], if they have the same random numbers, and the seed of random signs. Returns
/// p, χ²/dof, the relative difference and the relative difference from noise alone.
#[pyfunction]
pub(crate) fn two_samples(
    a: Measured<'_>,
    b: Measured<'_>,
    pairs: Option<(
        PyReadonlyArray4<'_, Complex>,
        PyReadonlyArray4<'_, Complex>,
        u64,
    )>,
) -> PyResult<(Option<f64>, Option<f64>, f64, f64)> {
    let shape = a.0.as_array().dim();
    let (azimuths, rho, nu) = shape;
    let shapes = [&a, &b].map(|one| [one.0.as_array().dim(), one.1.as_array().dim()]);
    if shapes != [[shape; 2]; 2] || rho % 2 == 0 || nu % 2 == 0 || a.3.min(b.3) < 4 {
        let what = "allowed: two spectra at the same frequencies, each of at least four batches";
        return Err(PyValueError::new_err(what));
    }
    let axis = |count: usize| FrequencyAxis {
        half: count / 2,
        spacing: 1.0,
    };
    let grid = SliceGrid {
        azimuths,
        rho: axis(rho),
        nu: axis(nu),
    };
    let [a, b] = [a, b].map(|(slices, sigma, noise_dof, batches)| Sample {
        mean: half(slices.as_array()),
        sigma: half(sigma.as_array()),
        noise_dof,
        batches,
    });
    let found = match pairs {
        None => TwoSamples::new(&grid, &a, &b),
        Some((of_a, of_b, seed)) => {
            let [of_a, of_b] = [of_a.as_array(), of_b.as_array()];
            let half = [b.batches, azimuths, grid.rho.half + 1, nu];
            if [of_a.shape(), of_b.shape()] != [half; 2] || b.batches < 4 {
                let what = format!("batches must have the shape {half:?}");
                return Err(PyValueError::new_err(what));
            }
            let differences = Residuals::of_pairs(grid, of_a.outer_iter(), of_b.outer_iter());
            TwoSamples::paired(&grid, [&a, &b], &differences, seed)
        }
    };
    Ok((
        found.p_value,
        found.chi2_per_dof,
        found.difference,
        found.noise,
    ))
}

/// Returns the half of the slices with ρ ≥ 0.
fn half<T: Clone>(full: ArrayView3<'_, T>) -> Array3<T> {
    let middle = full.len_of(Axis(1)) / 2;
    full.split_at(Axis(1), middle).1.to_owned()
}
