//! The 4D grid of a light field.

use crate::{SliceGrid, TwoPlane, Window};
use serde::{Deserialize, Serialize};

/// A 4D grid over the support of a window. Its axes are in the order x, y, u, v.
///
/// Along an axis of half-width h and n cells, the grid is periodic with the period 2h, and cell i
/// is centred at (i − n/2) · 2h/n. The plane's origin is therefore the centre of cell n/2. One half
/// of cell 0 lies at the lower end of the period, and the other half at the upper end. The
/// frequencies of its transform are the multiples of 1/(2h) up to the Nyquist frequency n/(4h).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FieldGrid {
    /// Number n of cells along each axis: even, at least 8.
    pub cells: [usize; 4],
    /// Half-width h of the box along each axis: metres for x and y, slope for u and v.
    pub half_widths: [f64; 4],
}

impl FieldGrid {
    /// The smallest grid over the support of `window` that is fine enough for `slices`. Its
    /// Nyquist frequencies are at least the largest frequencies of `slices`.
    #[must_use]
    pub fn new(window: &Window, slices: &SliceGrid) -> Self {
        let half_widths = [window.x, window.y, window.u, window.v].map(|p| p.half_width());
        let max = [slices.rho.max(), slices.nu.max()];
        let mut cells = [0; 4];
        for (axis, n) in cells.iter_mut().enumerate() {
            *n = even_cells(max[axis / 2] * 2.0 * half_widths[axis]);
        }
        Self { cells, half_widths }
    }

    /// The number of bytes of one grid of f64, or of its transform. Saturates at
    /// `u64::MAX`, so a caller can check the size of a grid before allocating the grid.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let [nx, ny, nu, nv] = self.cells.map(|n| n as u64);
        // The transform of a row of n reals has n/2 + 1 complex numbers, which are stored in place
        // of the row.
        [nx, ny, nu, nv.saturating_add(2)]
            .into_iter()
            .fold(8, u64::saturating_mul)
    }

    /// The width of a cell along `axis`.
    #[must_use]
    pub fn cell_width(&self, axis: usize) -> f64 {
        2.0 * self.half_widths[axis] / self.cells[axis] as f64
    }

    /// The volume of a cell, metre² · slope².
    #[must_use]
    pub fn cell_volume(&self) -> f64 {
        (0..4).map(|axis| self.cell_width(axis)).product()
    }

    /// The centre of cell `i` along `axis`.
    #[must_use]
    pub fn center(&self, axis: usize, i: usize) -> f64 {
        (i as f64 - self.cells[axis] as f64 / 2.0) * self.cell_width(axis)
    }

    /// The coordinates t of a ray in units of cells: whole numbers at the centres of cells,
    /// 0 ≤ t < n inside the box.
    #[inline]
    #[must_use]
    pub fn position(&self, ray: &TwoPlane) -> [f64; 4] {
        let z = [ray.x, ray.y, ray.u, ray.v];
        std::array::from_fn(|axis| {
            (z[axis] / self.half_widths[axis] + 1.0) * 0.5 * self.cells[axis] as f64
        })
    }

    /// The spacing 1/(2h) of the frequencies along `axis`, cycles per unit.
    #[must_use]
    pub fn spacing(&self, axis: usize) -> f64 {
        0.5 / self.half_widths[axis]
    }

    /// The Nyquist frequency n/(4h) along `axis`.
    #[must_use]
    pub fn nyquist(&self, axis: usize) -> f64 {
        self.cells[axis] as f64 / 2.0 * self.spacing(axis)
    }

    /// The frequency at index `i` of the transform along `axis`, as a multiple of the
    /// spacing. The multiples are 0, 1, … n/2 − 1, −n/2, … −1.
    #[inline]
    #[must_use]
    #[expect(
        clippy::cast_possible_wrap,
        reason = "a grid in memory has fewer cells than isize::MAX"
    )]
    pub fn harmonic(&self, axis: usize, i: usize) -> isize {
        let n = self.cells[axis] as isize;
        let i = i as isize;
        if 2 * i < n { i } else { i - n }
    }

    /// The 4D frequency (Ωx, Ωy, Ωu, Ωv) at `index` of the transform.
    #[must_use]
    pub fn frequency(&self, index: [usize; 4]) -> [f64; 4] {
        std::array::from_fn(|axis| self.harmonic(axis, index[axis]) as f64 * self.spacing(axis))
    }
}

/// The method that assigns a weighted ray to the cells of a [`FieldGrid`]. Along each axis, a
/// B-spline over the cells gives the weight in each cell (Hockney and Eastwood 1981, section 5-3,
/// which also gives the names of the methods).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Assignment {
    /// Nearest grid point, order 1: the cell of the ray receives all of the weight.
    Nearest,
    /// Cloud in cell, order 2: two cells share the weight, linearly.
    Cic,
    /// Triangular shaped cloud, order 3: three cells share the weight, by quadratic functions.
    #[default]
    Tsc,
}

impl Assignment {
    /// The order p of the B-spline. The spline extends over p cells along an axis, and its
    /// transform is the sinc to the power of p.
    #[inline]
    #[must_use]
    pub fn order(&self) -> usize {
        match self {
            Self::Nearest => 1,
            Self::Cic => 2,
            Self::Tsc => 3,
        }
    }
}

/// Twice `spacings` rounded up to a whole number, at least 8.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the number is not negative; a number too large for usize becomes usize::MAX"
)]
fn even_cells(spacings: f64) -> usize {
    // Because of rounding, a product that equals a whole number may be slightly above this number.
    // An example is 0.7 · 2 · (5/1.4).
    let whole = (spacings * (1.0 - 1e-12)).ceil();
    (whole as usize).saturating_mul(2).max(8)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FrequencyAxis, Profile};

    fn grid(half_y: f64, max: [f64; 2]) -> FieldGrid {
        let window = Window {
            x: Profile::Hann(0.7),
            y: Profile::Box(half_y),
            u: Profile::Hann(0.4),
            v: Profile::Hann(0.4),
        };
        let axis = |max: f64| FrequencyAxis {
            half: 10,
            spacing: max / 10.0,
        };
        let slices = SliceGrid {
            azimuths: 8,
            rho: axis(max[0]),
            nu: axis(max[1]),
        };
        FieldGrid::new(&window, &slices)
    }

    #[test]
    fn cells_reach_the_slices_frequencies() {
        // The frequency 12/1.4 is 12 spacings on a box of width 1.4, and 8.57 on a box of width 1,
        // rounded up to 9. The frequency 9.9 is 7.92 spacings on a box of width 0.8, rounded up to
        // 8.
        let grid = grid(0.5, [12.0 / 1.4, 9.9]);
        assert_eq!(grid.cells, [24, 18, 16, 16]);
        assert!(grid.nyquist(1) >= 12.0 / 1.4);
        assert_eq!(grid.bytes(), 24 * 18 * 16 * 18 * 8);
    }

    #[test]
    fn small_grids_have_eight_cells_and_huge_ones_a_size() {
        assert_eq!(grid(0.5, [0.1, 0.1]).cells, [8; 4]);
        assert_eq!(grid(0.5, [1e30, 1e30]).bytes(), u64::MAX);
    }

    #[test]
    fn the_origin_is_the_centre_of_a_cell() {
        let grid = grid(0.5, [6.0, 11.0]);
        let origin = grid.position(&TwoPlane::default());
        for (axis, (n, t)) in grid.cells.into_iter().zip(origin).enumerate() {
            assert!((t - (n / 2) as f64).abs() < f64::MIN_POSITIVE);
            assert!(grid.center(axis, n / 2).abs() < f64::MIN_POSITIVE);
        }
        let ray = TwoPlane {
            x: grid.center(0, 3),
            y: grid.center(1, 0),
            u: grid.center(2, 1),
            v: grid.center(3, 7),
        };
        for (t, i) in grid.position(&ray).into_iter().zip([3.0, 0.0, 1.0, 7.0]) {
            assert!((t - i).abs() < 1e-14); // rounding
        }
    }

    #[test]
    fn harmonics_are_those_of_a_transform() {
        let grid = grid(0.5, [0.1, 0.1]);
        let all: Vec<_> = (0..8).map(|i| grid.harmonic(2, i)).collect();
        assert_eq!(all, [0, 1, 2, 3, -4, -3, -2, -1]);
        let [x, .., v] = grid.frequency([1, 0, 0, 7]);
        assert!((x - 1.0 / 1.4).abs() < 1e-15 && (v + 1.25).abs() < 1e-15); // rounding
    }
}
