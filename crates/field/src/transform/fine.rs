use super::kernel::{Kernel, WIDTH};
use super::spread::Placement;
use crate::{Complex, FrequencyAxis, SliceGrid};
use ndarray::ArrayViewMut2;
use rustfft::{Fft, FftPlannerScalar};
use std::sync::Arc;

/// From padded fine grids to slices: wrap, transform, keep the wanted frequencies, divide by the
/// transform of the spreading kernel.
pub(crate) struct FineTransform {
    placement: Placement,
    grid: SliceGrid,
    along_row: Arc<dyn Fft<f64>>,
    along_column: Arc<dyn Fft<f64>>,
    /// 1/kernel at ρ ≥ 0, and at all ν.
    correction: [Vec<f64>; 2],
}

/// Memory for [`FineTransform::slices`].
#[derive(Clone, Debug)]
pub(crate) struct Workspace {
    /// The fine grids of two azimuths, one real and one imaginary, [row, column].
    cells: Vec<Complex>,
    /// Their transform at the wanted ν, [ν, row].
    columns: Vec<Complex>,
    scratch: Vec<Complex>,
}

#[cfg(test)]
impl Workspace {
    pub(crate) fn bytes(&self) -> usize {
        let Self {
            cells,
            columns,
            scratch,
        } = self;
        [cells, columns, scratch]
            .map(|v| size_of_val(&**v))
            .iter()
            .sum()
    }
}

impl FineTransform {
    /// The transform of fine grids laid out as `placement`, at the frequencies of `grid`.
    pub(crate) fn new(kernel: &Kernel, placement: Placement, grid: SliceGrid) -> Self {
        // The scalar planner: the automatic one picks other algorithms on other processors, and
        // other bits.
        let mut planner = FftPlannerScalar::new();
        let correction = |axis: &FrequencyAxis, cells: usize| -> Vec<f64> {
            let index = |i: usize| (i as f64 - axis.half as f64) / cells as f64;
            let values = (0..axis.count()).map(|i| 1.0 / kernel.transform(index(i)));
            values.collect()
        };
        Self {
            placement,
            grid,
            along_row: planner.plan_fft_forward(placement.columns),
            along_column: planner.plan_fft_forward(placement.rows),
            correction: [
                correction(&grid.rho, placement.rows).split_off(grid.rho.half),
                correction(&grid.nu, placement.columns),
            ],
        }
    }

    /// Cells of a workspace.
    pub(crate) fn workspace_cells(&self) -> usize {
        let Placement { rows, columns, .. } = self.placement;
        (columns + self.grid.nu.count()) * rows + self.scratch()
    }

    fn scratch(&self) -> usize {
        usize::max(
            self.along_row.get_inplace_scratch_len(),
            self.along_column.get_inplace_scratch_len(),
        )
    }

    /// The memory it works in.
    pub(crate) fn workspace(&self) -> Workspace {
        let Placement { rows, columns, .. } = self.placement;
        Workspace {
            cells: vec![Complex::ZERO; rows * columns],
            columns: vec![Complex::ZERO; self.grid.nu.count() * rows],
            scratch: vec![Complex::ZERO; self.scratch()],
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
        self.wrap(fine, &mut work.cells);
        self.along_row
            .process_with_scratch(&mut work.cells, &mut work.scratch);
        self.gather(&work.cells, &mut work.columns);
        self.along_column
            .process_with_scratch(&mut work.columns, &mut work.scratch);

        let rows = self.placement.rows;
        let last = self.grid.nu.count() - 1;
        // 1/2 for a, 1/(2i) for b.
        let factors = [Complex::new(0.5, 0.0), Complex::new(0.0, -0.5)];
        for ((slice, sign), factor) in slices.into_iter().zip([1.0, -1.0]).zip(factors) {
            let Some(mut slice) = slice else { continue };
            for ((m, n), value) in slice.indexed_iter_mut() {
                let z = work.columns[n * rows + m];
                let mirrored = work.columns[(last - n) * rows + (rows - m) % rows].conj();
                let correction = scale * self.correction[0][m] * self.correction[1][n];
                *value = (z + mirrored * sign) * factor * correction;
            }
        }
    }

    /// Wraps two padded grids onto the period, as the real and imaginary parts of `cells`.
    fn wrap(&self, [a, b]: [&[f64]; 2], cells: &mut [Complex]) {
        let Placement { rows, columns, .. } = self.placement;
        let stride = self.placement.padded()[1];
        // A point spreads from three cells before its own on.
        let before = WIDTH / 2 - 1;
        cells.fill(Complex::ZERO);
        for (i, (a, b)) in a
            .chunks_exact(stride)
            .zip(b.chunks_exact(stride))
            .enumerate()
        {
            let row = (i + rows - before) % rows * columns;
            for (j, (a, b)) in a.iter().zip(b).enumerate() {
                cells[row + (j + columns - before) % columns] += Complex::new(*a, *b);
            }
        }
    }

    /// Picks the wanted ν out of the transformed rows: [row, column] to [ν, row].
    fn gather(&self, cells: &[Complex], picked: &mut [Complex]) {
        let Placement { rows, columns, .. } = self.placement;
        for (n, column) in picked.chunks_exact_mut(rows).enumerate() {
            let from = (n + columns - self.grid.nu.half) % columns;
            for (row, value) in column.iter_mut().enumerate() {
                *value = cells[row * columns + from];
            }
        }
    }
}
