//! The light field integrated over y and v, which is shown in pictures.

use crate::Window;

/// A grid of `bins` × `bins` cells over the (x, u) support of a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProjectionGrid {
    /// Number of cells along x and along u.
    pub bins: usize,
    /// Half-width in x, metres.
    pub half_x: f64,
    /// Half-width in u, as a slope.
    pub half_u: f64,
}

impl ProjectionGrid {
    /// The grid over the support of `window`.
    #[must_use]
    pub fn new(window: &Window, bins: usize) -> Self {
        Self {
            bins,
            half_x: window.x.half_width(),
            half_u: window.u.half_width(),
        }
    }

    /// The cell [x, u] that contains (x, u); `None` outside the window.
    #[inline]
    #[must_use]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "checked to be in 0..bins first"
    )]
    pub fn cell(&self, x: f64, u: f64) -> Option<[usize; 2]> {
        let n = self.bins as f64;
        let i = (x / self.half_x + 1.0) * 0.5 * n;
        let j = (u / self.half_u + 1.0) * 0.5 * n;
        ((0.0..n).contains(&i) && (0.0..n).contains(&j)).then_some([i as usize, j as usize])
    }

    /// The centre of cell `i` along an axis of half-width `half`.
    #[must_use]
    pub fn center(&self, i: usize, half: f64) -> f64 {
        ((i as f64 + 0.5) / self.bins as f64 * 2.0 - 1.0) * half
    }

    /// The area of a cell, metre · slope.
    #[must_use]
    pub fn cell_area(&self) -> f64 {
        4.0 * self.half_x * self.half_u / (self.bins * self.bins) as f64
    }
}

/// The windowed light field integrated over y and v, ∫∫ L W dy dv. The values are means over cells
/// of (x, u).
///
/// By the Fourier slice theorem the integral is the primal counterpart of the slice at azimuth 0.
/// The array has the axes [x, u], both ascending. Unit: W m⁻² sr⁻¹ · m.
#[derive(Clone, Debug, PartialEq)]
pub struct Projection {
    /// The grid of cells.
    pub grid: ProjectionGrid,
    /// The mean over each cell, [x, u].
    pub values: ndarray::Array2<f64>,
}
