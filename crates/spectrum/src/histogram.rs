//! Sums the light field in cells of x and u.

use crate::ray_moments::LANES;
use etendue_field::{Projection, ProjectionGrid};
use ndarray::Array2;

/// A sum of weighted rays in cells of (x, u), which becomes a [`Projection`]. A projection is the
/// counterpart of the slice at azimuth 0.
#[derive(Clone, Debug)]
pub(crate) struct ProjectionHistogram {
    grid: ProjectionGrid,
    /// The sum of the weights w of the rays in each cell, [x, u], and of the rays outside.
    sums: Vec<f64>,
}

impl ProjectionHistogram {
    /// An empty histogram over `grid`.
    #[must_use]
    pub(crate) fn new(grid: ProjectionGrid) -> Self {
        Self {
            grid,
            sums: vec![0.0; grid.bins * grid.bins + 1],
        }
    }

    /// Adds rays given as columns of x, u and weight; rays outside the grid are ignored. The weights
    /// beyond `count`, up to a multiple of [`LANES`], must be zero.
    #[inline(always)]
    pub(crate) fn deposit<const N: usize>(&mut self, columns: [&[f64; N]; 3], count: usize) {
        const { assert!(N.is_multiple_of(LANES)) };
        let [x, u, weights] = columns.map(|column| column.as_chunks::<LANES>().0);
        let grid = self.grid;
        let outside = grid.bins * grid.bins;
        for i in 0..count.div_ceil(LANES) {
            let mut cells = [0; LANES];
            for ((cell, x), u) in cells.iter_mut().zip(&x[i]).zip(&u[i]) {
                *cell = grid
                    .cell(*x, *u)
                    .map_or(outside, |[a, b]| a * grid.bins + b);
            }
            for (cell, weight) in cells.iter().zip(&weights[i]) {
                self.sums[*cell] += weight;
            }
        }
    }

    /// Returns Σ w · `scale` / (area of a cell) for each cell, and sets the histogram to zero.
    ///
    /// If `scale` is 1/(number of emitted photons), the result estimates the mean of ∫∫ L W dy dv
    /// over each cell.
    #[must_use]
    pub(crate) fn finish(&mut self, scale: f64) -> Projection {
        let factor = scale / self.grid.cell_area();
        let bins = self.grid.bins;
        let values = Array2::from_shape_fn((bins, bins), |(i, j)| self.sums[i * bins + j] * factor);
        self.sums.fill(0.0);
        Projection {
            grid: self.grid,
            values,
        }
    }
}
