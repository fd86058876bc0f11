//! From fine grids to slices.

use super::kernel::{Kernel, WIDTH};
use super::spread::Placement;
use crate::fft::{COLUMNS, Fft, Row};
use crate::{Complex, FrequencyAxis, SliceGrid};
use ndarray::ArrayViewMut2;

/// From padded fine grids to slices: wrap, transform, keep the wanted frequencies, divide by the
/// transform of the spreading kernel.
pub(crate) struct FineTransform {
    placement: Placement,
    grid: SliceGrid,
    along_column: Fft,
    along_row: Fft,
    /// 1/kernel at ρ ≥ 0, and at all ν.
    correction: [Vec<f64>; 2],
}

/// Memory for [`FineTransform::slices`].
#[derive(Clone, Debug)]
pub(crate) struct Workspace {
    /// Eight columns of a transform, and its scratch memory.
    eight: [Vec<Row>; 2],
    /// The transform along columns at the wanted ρ, negative ones too: [ρ, column].
    rows: Vec<Complex>,
    /// That along rows as well, at the wanted ν: [ρ, ν].
    frequencies: Vec<Complex>,
}

#[cfg(test)]
impl Workspace {
    pub(crate) fn bytes(&self) -> usize {
        let Self {
            eight,
            rows,
            frequencies,
        } = self;
        let eight = eight.iter().map(|v| size_of_val(&**v)).sum::<usize>();
        eight + size_of_val(&**rows) + size_of_val(&**frequencies)
    }
}

impl FineTransform {
    /// The transform of fine grids laid out as `placement`, at the frequencies of `grid`.
    pub(crate) fn new(kernel: &Kernel, placement: Placement, grid: SliceGrid) -> Self {
        let correction = |axis: &FrequencyAxis, cells: usize| -> Vec<f64> {
            let index = |i: usize| (i as f64 - axis.half as f64) / cells as f64;
            let values = (0..axis.count()).map(|i| 1.0 / kernel.transform(index(i)));
            values.collect()
        };
        Self {
            placement,
            grid,
            along_column: Fft::new(placement.rows),
            along_row: Fft::new(placement.columns),
            correction: [
                correction(&grid.rho, placement.rows).split_off(grid.rho.half),
                correction(&grid.nu, placement.columns),
            ],
        }
    }

    /// Complex numbers in the rows of a workspace, and among its frequencies.
    fn sizes(&self) -> [usize; 2] {
        [self.placement.columns, self.grid.nu.count()].map(|n| n * self.grid.rho.count())
    }

    /// Rows of eight columns: the longer way.
    fn longest(&self) -> usize {
        self.placement.rows.max(self.placement.columns)
    }

    /// Complex numbers of a workspace.
    pub(crate) fn workspace_cells(&self) -> usize {
        2 * COLUMNS * self.longest() + self.sizes().iter().sum::<usize>()
    }

    /// The memory it works in.
    pub(crate) fn workspace(&self) -> Workspace {
        let [rows, frequencies] = self.sizes().map(|n| vec![Complex::ZERO; n]);
        let eight = || vec![Row::default(); self.longest()];
        Workspace {
            eight: [eight(), eight()],
            rows,
            frequencies,
        }
    }

    /// The slices [ρ ≥ 0, ν] of two azimuths from their padded fine grids, times `scale`.
    ///
    /// Both are real, so they share one complex transform Z of a + ib: the parts with and without
    /// the symmetry of a real field, (Z(m, n) ± conj Z(−m, −n))/2, belong to a and to ib.
    pub(crate) fn slices(
        &self,
        fine: [&[f64]; 2],
        scale: f64,
        work: &mut Workspace,
        slices: [Option<ArrayViewMut2<'_, Complex>>; 2],
    ) {
        self.columns(fine, &mut work.eight, &mut work.rows);
        self.rows(&work.rows, &mut work.eight, &mut work.frequencies);

        let nus = self.grid.nu.count();
        // 1/2 for a, 1/(2i) for b.
        let factors = [Complex::new(0.5, 0.0), Complex::new(0.0, -0.5)];
        for ((slice, sign), factor) in slices.into_iter().zip([1.0, -1.0]).zip(factors) {
            let Some(mut slice) = slice else { continue };
            for ((m, n), value) in slice.indexed_iter_mut() {
                let (up, down) = (self.grid.rho.half + m, self.grid.rho.half - m);
                let z = work.frequencies[up * nus + n];
                let mirrored = work.frequencies[down * nus + nus - 1 - n].conj();
                let correction = scale * self.correction[0][m] * self.correction[1][n];
                *value = (z + mirrored * sign) * factor * correction;
            }
        }
    }

    /// Wraps two padded grids onto the period, as real and imaginary part of one, and transforms
    /// its columns.
    fn columns(&self, [a, b]: [&[f64]; 2], eight: &mut [Vec<Row>; 2], to: &mut [Complex]) {
        let Placement { rows, columns, .. } = self.placement;
        let stride = self.placement.padded()[1];
        // A point spreads from three cells before its own on.
        let before = WIDTH / 2 - 1;
        let [cells, scratch] = eight.each_mut().map(|v| &mut v[..rows]);
        for first in (0..columns).step_by(COLUMNS) {
            let count = COLUMNS.min(columns - first);
            cells.fill(Row::default());
            for (i, (a, b)) in a
                .chunks_exact(stride)
                .zip(b.chunks_exact(stride))
                .enumerate()
            {
                let cell = &mut cells[(i + rows - before) % rows];
                for c in 0..count {
                    // Where the column lies in the padded row, once or, near an end, twice.
                    let at = (first + c + before) % columns;
                    for j in [at, at + columns].into_iter().filter(|j| *j < stride) {
                        cell.re[c] += a[j];
                        cell.im[c] += b[j];
                    }
                }
            }
            self.along_column.forward(cells, scratch);
            for (m, row) in to.chunks_exact_mut(columns).enumerate() {
                let from = &cells[(m + rows - self.grid.rho.half) % rows];
                for (c, value) in row[first..first + count].iter_mut().enumerate() {
                    *value = Complex::new(from.re[c], from.im[c]);
                }
            }
        }
    }

    /// Transforms rows, eight at a time, and keeps the wanted ν.
    fn rows(&self, rows: &[Complex], eight: &mut [Vec<Row>; 2], to: &mut [Complex]) {
        let columns = self.placement.columns;
        let nus = self.grid.nu.count();
        let [cells, scratch] = eight.each_mut().map(|v| &mut v[..columns]);
        let groups = rows.chunks(COLUMNS * columns);
        for (rows, to) in groups.zip(to.chunks_mut(COLUMNS * nus)) {
            for (c, row) in rows.chunks_exact(columns).enumerate() {
                for (cell, value) in cells.iter_mut().zip(row) {
                    (cell.re[c], cell.im[c]) = (value.re, value.im);
                }
            }
            self.along_row.forward(cells, scratch);
            for (c, row) in to.chunks_exact_mut(nus).enumerate() {
                for (n, value) in row.iter_mut().enumerate() {
                    let from = &cells[(n + columns - self.grid.nu.half) % columns];
                    *value = Complex::new(from.re[c], from.im[c]);
                }
            }
        }
    }
}
