//! Subtracts the mean of a light field from the field.
//!
//! Most of the power of a typical spectrum comes from the mean of the light in the window. The
//! bandwidth of the total power would therefore say little about how fast the light changes.

use etendue_field::{Complex, SliceGrid, Slices, Window};
use ndarray::{Array2, Array3};

/// The mean of a light field times the window, which is subtracted from the field's slices.
#[derive(Clone, Debug)]
pub struct WindowedMean {
    /// The transform of the window divided by its value at zero, Ŵ / Ŵ(0), [azimuth, ρ ≥ 0, ν].
    shape: Array3<f64>,
}

impl WindowedMean {
    /// Prepares the subtraction of the mean under a window, at the frequencies of a grid.
    #[must_use]
    pub fn new(window: &Window, grid: &SliceGrid) -> Self {
        let shape = transform(window, grid);
        let whole = shape[[0, 0, grid.nu.half]];
        Self {
            shape: shape / whole,
        }
    }

    /// Subtracts the mean from the slices of a windowed light field. Let F be the spectrum of the
    /// light field times the window W. The result is F − F(0) Ŵ / Ŵ(0).
    ///
    /// The result is the spectrum of a product: the window times the deviation of the light field
    /// from its mean. The mean is weighted by the window.
    ///
    /// # Panics
    ///
    /// Panics if the slices are on another grid.
    #[must_use]
    pub fn removed_from(&self, slices: &Slices) -> Slices {
        let mean = slices.at_zero();
        let mut varying = slices.clone();
        varying.half.zip_mut_with(&self.shape, |value, shape| {
            *value -= Complex::from(mean * shape);
        });
        varying
    }

    /// Subtracts the mean of the light field from each of several slices, such as the slices of
    /// several batches. Each of them has its own mean.
    ///
    /// # Panics
    ///
    /// Panics if any of the slices are on another grid.
    #[must_use]
    pub fn removed_from_all<'s>(&self, all: impl Iterator<Item = &'s Slices>) -> Vec<Slices> {
        all.map(|slices| self.removed_from(slices)).collect()
    }
}

/// The transform of a window at the frequencies of a grid, [azimuth, ρ ≥ 0, ν].
pub(crate) fn transform(window: &Window, grid: &SliceGrid) -> Array3<f64> {
    let shape = grid.half_shape();
    let [azimuths, rho, nu] = shape;
    let positions = Array2::from_shape_fn((azimuths, rho), |(k, m)| {
        let [x, y, ..] = grid.frequency(k, m as f64 * grid.rho.spacing, 0.0);
        window.x.transform(x) * window.y.transform(y)
    });
    let slopes = Array2::from_shape_fn((azimuths, nu), |(k, n)| {
        let [.., u, v] = grid.frequency(k, 0.0, grid.nu.value(n));
        window.u.transform(u) * window.v.transform(v)
    });
    Array3::from_shape_fn(shape, |(k, m, n)| positions[[k, m]] * slopes[[k, n]])
}
