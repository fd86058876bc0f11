//! Sums the light field in cells of x and u.

use etendue_field::{Projection, ProjectionGrid};
use ndarray::Array2;

/// A sum of weighted rays in cells of (x, u), which becomes a [`Projection`]. A projection is the
/// counterpart of the slice at azimuth 0.
#[derive(Clone, Debug)]
pub struct ProjectionHistogram {
    grid: ProjectionGrid,
    /// The sum of the weights w of the rays in each cell, [x, u].
    sums: Array2<f64>,
}

impl ProjectionHistogram {
    /// Returns an empty histogram over `grid`.
    #[must_use]
    pub fn new(grid: ProjectionGrid) -> Self {
        Self {
            grid,
            sums: Array2::zeros((grid.bins, grid.bins)),
        }
    }

    /// Adds a ray at (x, u); rays outside the grid are ignored.
    #[inline]
    pub fn deposit(&mut self, [x, u]: [f64; 2], weight: f64) {
        if let Some(cell) = self.grid.cell(x, u) {
            self.sums[cell] += weight;
        }
    }

    /// Returns Σ w · `scale` / (area of a cell) for each cell, and sets the histogram to zero.
    ///
    /// If `scale` is 1/(number of emitted photons), the result estimates the mean of ∫∫ L W dy dv
    /// over each cell.
    #[must_use]
    pub fn finish(&mut self, scale: f64) -> Projection {
        let values = &self.sums * (scale / self.grid.cell_area());
        self.sums.fill(0.0);
        Projection {
            grid: self.grid,
            values,
        }
    }
}
