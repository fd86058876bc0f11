//! Slices of a spectrum.

use crate::{Complex, FrequencyAxis, SliceGrid, cis};
use ndarray::{Array2, Array3, ArrayView1, ArrayView2, ArrayView3, Axis};
use std::f64::consts::TAU;

/// The slices S_φ(ρ, ν) = ℓ̂(ρ cos φ, ρ sin φ, ν cos φ, ν sin φ) of the spectrum of a windowed light field.
///
/// The field is real, so S(−ρ, −ν) is the conjugate of S(ρ, ν), and only ρ ≥ 0 is stored. The array
/// `half` is [azimuth, ρ ≥ 0, ν], and ν ascends from −max to +max.
///
/// The unit is the unit of ∫ L W dx dy du dv, which is W m⁻² sr⁻¹ · m².
#[derive(Clone, Debug, PartialEq)]
pub struct Slices {
    /// The frequencies.
    pub grid: SliceGrid,
    /// The values at ρ ≥ 0, [azimuth, ρ ≥ 0, ν].
    pub half: Array3<Complex>,
}

impl Slices {
    /// Slices with all values zero.
    #[must_use]
    pub fn zeros(grid: SliceGrid) -> Self {
        Self {
            grid,
            half: Array3::zeros(grid.half_shape()),
        }
    }

    /// Checks whether all values are zero, which means that there is no light.
    #[must_use]
    pub fn is_dark(&self) -> bool {
        self.half.iter().all(|s| s.norm_sqr() <= 0.0)
    }

    /// ‖ℓ̂‖, the root of the sum of |ℓ̂|² over the stored half.
    #[must_use]
    pub fn norm(&self) -> f64 {
        let squares = self.half.iter().map(|s| s.norm_sqr());
        squares.sum::<f64>().sqrt()
    }

    /// The value ℓ̂(0) = ∫ L W.
    #[must_use]
    pub fn at_zero(&self) -> f64 {
        self.half[[0, 0, self.grid.nu.half]].re
    }

    /// All frequencies, [azimuth, ρ, ν], ρ and ν ascending.
    #[must_use]
    pub fn full(&self) -> Array3<Complex> {
        unfold(&self.grid, self.half.view(), |s| s.conj())
    }

    /// The windowed light field over the position and the slope along an azimuth, integrated over
    /// the other position and slope, in `cells` × `cells` cells that fill ± `half_widths`. By the
    /// Fourier slice theorem, its spectrum is the slice at that azimuth. It contains no frequencies
    /// beyond the grid.
    #[must_use]
    pub fn light_field(&self, azimuth: usize, cells: usize, half_widths: [f64; 2]) -> Array2<f64> {
        let SliceGrid { rho, nu, .. } = &self.grid;
        let full = self.full();
        let slice = full.index_axis(Axis(0), azimuth);
        // The factors e^(2πi Ω z) dΩ of the transform, [cell, frequency].
        let waves = |axis: &FrequencyAxis, half: f64| {
            let values = axis.values();
            Array2::from_shape_fn((cells, values.len()), |(cell, i)| {
                let z = half * ((2 * cell + 1) as f64 / cells as f64 - 1.0);
                cis(TAU * values[i] * z) * axis.spacing
            })
        };
        let [x, u] = [waves(rho, half_widths[0]), waves(nu, half_widths[1])];
        // The sum is written out, because matrix products of the array library differ in their
        // bits between processors.
        let sum = |a: ArrayView1<'_, Complex>, b: ArrayView1<'_, Complex>| {
            let terms = a.iter().zip(b).map(|(a, b)| a * b);
            terms.fold(Complex::ZERO, |sum, term| sum + term)
        };
        let over_x =
            Array2::from_shape_fn((cells, nu.count()), |(i, k)| sum(x.row(i), slice.column(k)));
        Array2::from_shape_fn((cells, cells), |(i, j)| sum(over_x.row(i), u.row(j)).re)
    }

    /// |S|² averaged over the azimuths, [ρ, ν], ρ and ν ascending.
    #[must_use]
    pub fn radial_power(&self) -> Array2<f64> {
        let mut power = Array2::zeros((self.grid.rho.count(), self.grid.nu.count()));
        for slice in self.full().outer_iter() {
            power.zip_mut_with(&slice, |p, s| *p += s.norm_sqr());
        }
        power / self.grid.azimuths as f64
    }

    /// ‖self − reference‖/‖reference‖ over the values at ρ ≥ 0; 0 if the two are equal.
    #[must_use]
    pub fn relative_difference(&self, reference: &Self) -> f64 {
        self.relative_difference_where(reference, |_, _| true)
    }

    /// The relative difference over the independent frequencies. On the line ρ = 0, the
    /// values at −ν repeat the values at ν, so only half of the line counts.
    #[must_use]
    pub fn independent_relative_difference(&self, reference: &Self) -> f64 {
        self.relative_difference_where(reference, |m, n| self.grid.is_independent(m, n))
    }

    fn relative_difference_where(
        &self,
        reference: &Self,
        counts: impl Fn(usize, usize) -> bool,
    ) -> f64 {
        let (mut difference, mut size) = (0.0, 0.0);
        for (((_, m, n), a), b) in self.half.indexed_iter().zip(&reference.half) {
            if counts(m, n) {
                difference += (a - b).norm_sqr();
                size += b.norm_sqr();
            }
        }
        if difference == 0.0 {
            0.0
        } else {
            (difference / size).sqrt()
        }
    }
}

/// Copies values on the half-plane, [azimuth, ρ ≥ 0, ν], to all frequencies, [azimuth, ρ, ν], by
/// S(−ρ, −ν) = `mirrored`(S(ρ, ν)).
fn unfold<T: Copy>(
    grid: &SliceGrid,
    half: ArrayView3<'_, T>,
    mirrored: impl Fn(T) -> T,
) -> Array3<T> {
    let zero = grid.rho.half;
    let last = grid.nu.count() - 1;
    Array3::from_shape_fn(grid.full_shape(), |(k, i, n)| {
        if i >= zero {
            half[[k, i - zero, n]]
        } else {
            mirrored(half[[k, zero - i, last - n]])
        }
    })
}

impl SliceGrid {
    /// Copies real values that are even in (ρ, ν), such as errors or powers, from the half-plane
    /// [azimuth, ρ ≥ 0, ν] to all frequencies [azimuth, ρ, ν].
    #[must_use]
    pub fn unfold_even(&self, half: ArrayView3<'_, f64>) -> Array3<f64> {
        unfold(self, half, |value| value)
    }

    /// Copies even values that are averaged over the azimuths from [ρ ≥ 0, ν] to all frequencies
    /// [ρ, ν].
    #[must_use]
    pub fn unfold_radial(&self, half: ArrayView2<'_, f64>) -> Array2<f64> {
        let one = Self {
            azimuths: 1,
            ..*self
        };
        let full = one.unfold_even(half.insert_axis(Axis(0)));
        full.index_axis_move(Axis(0), 0)
    }
}
