//! The step from padded fine grids to slices.

use super::kernel::Kernel;
use super::spread::Placement;
use etendue_field::{Complex, FrequencyAxis, SliceGrid};
use ndarray::ArrayViewMut2;
use realfft::{RealFftPlanner, RealToComplex};
use rustfft::{Fft, FftPlanner};
use std::sync::Arc;

/// Number of rows of the fine grid that are transformed together. One column of this many rows
/// fills a cache line.
const ROWS: usize = 4;

/// Computes slices from padded fine grids. It wraps and transforms the grids, keeps the wanted
/// frequencies, and divides by the transform of the spreading kernel.
pub(crate) struct FineTransform {
    placement: Placement,
    /// Number of cells before the cell of a ray over which the ray is spread. Cell [i, j] of the
    /// padded grid is the cell [i − `before`, j − `before`] of the period.
    before: usize,
    grid: SliceGrid,
    along_row: Arc<dyn RealToComplex<f64>>,
    along_column: Arc<dyn Fft<f64>>,
    /// The inverse of the kernel's transform, at ρ ≥ 0 and at ν ≥ 0.
    correction: [Vec<f64>; 2],
}

/// Memory for [`FineTransform::slice`].
#[derive(Clone, Debug)]
pub(crate) struct Workspace {
    /// A wrapped row of the fine grid.
    row: Vec<f64>,
    /// The transforms of several rows, one after another.
    transformed: Vec<Complex>,
    /// The transform along rows, and then along columns, at the wanted ν ≥ 0: [ν, row].
    half: Vec<Complex>,
    /// Scratch memory of the one-dimensional transforms.
    scratch: Vec<Complex>,
}

impl Workspace {
    pub(crate) fn bytes(&self) -> usize {
        let complex = [&self.transformed, &self.half, &self.scratch];
        size_of_val(&*self.row) + complex.map(|v| size_of_val(&**v)).iter().sum::<usize>()
    }
}

impl FineTransform {
    /// Plans the transform of fine grids laid out as `placement`, at the frequencies of `grid`.
    pub(crate) fn new<const TAPS: usize>(
        kernel: &Kernel<f64, TAPS>,
        placement: Placement,
        grid: SliceGrid,
    ) -> Self {
        let correction = |axis: &FrequencyAxis, cells: usize| -> Vec<f64> {
            let value = |i: usize| 1.0 / kernel.transform(i as f64 / cells as f64);
            (0..=axis.half).map(value).collect()
        };
        Self {
            placement,
            before: TAPS / 2 - 1,
            grid,
            along_row: RealFftPlanner::new().plan_fft_forward(placement.columns),
            along_column: FftPlanner::new().plan_fft_forward(placement.rows),
            correction: [
                correction(&grid.rho, placement.rows),
                correction(&grid.nu, placement.columns),
            ],
        }
    }

    /// The working memory.
    pub(crate) fn workspace(&self) -> Workspace {
        let Placement { rows, columns, .. } = self.placement;
        let scratch = [
            self.along_row.get_scratch_len(),
            self.along_column.get_inplace_scratch_len(),
        ];
        Workspace {
            row: vec![0.0; columns],
            transformed: vec![Complex::ZERO; ROWS * (columns / 2 + 1)],
            half: vec![Complex::ZERO; (self.grid.nu.half + 1) * rows],
            scratch: vec![Complex::ZERO; scratch[0].max(scratch[1])],
        }
    }

    /// Computes the slice [ρ ≥ 0, ν] of one azimuth from its padded fine grid, times `scale`.
    ///
    /// The grid is real, so values at ν < 0 are conjugates of the values at (−ρ, −ν).
    pub(crate) fn slice(
        &self,
        fine: &[f64],
        scale: f64,
        work: &mut Workspace,
        mut slice: ArrayViewMut2<'_, Complex>,
    ) {
        self.rows(fine, work);
        self.along_column
            .process_with_scratch(&mut work.half, &mut work.scratch);
        let rows = self.placement.rows;
        let middle = self.grid.nu.half;
        for ((n, column), nu) in work
            .half
            .chunks_exact(rows)
            .enumerate()
            .zip(&self.correction[1])
        {
            for (m, rho) in self.correction[0].iter().enumerate() {
                let correction = scale * rho * nu;
                slice[[m, middle - n]] = column[(rows - m) % rows].conj() * correction;
                slice[[m, middle + n]] = column[m] * correction;
            }
        }
    }

    /// Transforms the rows of a padded grid and keeps the wanted ν ≥ 0.
    fn rows(&self, fine: &[f64], work: &mut Workspace) {
        let Placement { rows, columns, .. } = self.placement;
        let each = columns / 2 + 1;
        for first in (0..rows).step_by(ROWS) {
            let count = ROWS.min(rows - first);
            for (i, transformed) in work
                .transformed
                .chunks_exact_mut(each)
                .take(count)
                .enumerate()
            {
                self.wrap(fine, first + i, &mut work.row);
                self.along_row
                    .process_with_scratch(&mut work.row, transformed, &mut work.scratch)
                    .expect("the lengths of the plan");
            }
            for (n, column) in work.half.chunks_exact_mut(rows).enumerate() {
                for (i, value) in column[first..first + count].iter_mut().enumerate() {
                    *value = work.transformed[i * each + n];
                }
            }
        }
    }

    /// Computes row `index` of the period. Each cell of the row is the sum of the padded cells that
    /// map to it. Some of these padded cells are a period away from the cell.
    fn wrap(&self, fine: &[f64], index: usize, row: &mut [f64]) {
        let Placement { rows, columns, .. } = self.placement;
        let before = self.before;
        let [padded, stride] = self.placement.padded();
        row.fill(0.0);
        let at = (index + before) % rows;
        for i in [at, at + rows].into_iter().filter(|i| *i < padded) {
            let (start, rest) = fine[i * stride..][..stride].split_at(before);
            let (middle, end) = rest.split_at(columns);
            add(row, middle);
            add(&mut row[columns - before..], start);
            add(row, end);
        }
    }
}

/// Adds numbers to the beginning of a row.
fn add(row: &mut [f64], more: &[f64]) {
    for (value, more) in row.iter_mut().zip(more) {
        *value += more;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Stream, unit, words};
    use etendue_field::{Slices, cis, modulus};
    use ndarray::Axis;
    use std::f64::consts::TAU;

    /// Computes the plain sum over the cells of a padded grid at the frequencies m ≥ 0 and `nu`
    /// modulo the period, row by row. The first cell lies `before` cells before the period.
    fn plain(fine: &[f64], placement: Placement, before: usize, [m, nu]: [usize; 2]) -> Complex {
        let Placement { rows, columns, .. } = placement;
        // The fraction of a cycle is exact up to one division.
        let phase = |k: usize, i: usize, n: usize| {
            cis(-TAU * ((k * (i + n - before) % n) as f64 / n as f64))
        };
        let along = |row: &[f64]| -> Complex {
            let terms = row.iter().enumerate();
            terms.map(|(j, value)| phase(nu, j, columns) * *value).sum()
        };
        let lines = fine.chunks_exact(placement.padded()[1]).enumerate();
        lines.map(|(i, row)| phase(m, i, rows) * along(row)).sum()
    }

    #[test]
    fn slices_are_the_plain_sum_over_cells() {
        compare_with_plain_sum::<8>();
        compare_with_plain_sum::<6>();
    }

    fn compare_with_plain_sum<const TAPS: usize>() {
        let kernel = Kernel::<f64, TAPS>::new();
        for [rows, columns] in [[16, 16], [18, 25], [20, 27], [25, 40], [30, 48]] {
            let placement = Placement {
                rho: [0.0; 2],
                nu: [0.0; 2],
                rows,
                columns,
            };
            let axis = |cells: usize| FrequencyAxis {
                half: 2 * cells / 5,
                spacing: 1.0,
            };
            let grid = SliceGrid {
                azimuths: 1,
                rho: axis(rows),
                nu: axis(columns),
            };
            let transform = FineTransform::new(&kernel, placement, grid);
            let [padded, stride] = placement.padded();
            let number = |i: usize| unit(words(3, Stream::Photon, i as u64, 0)[0]) - 0.5;
            let fine: Vec<f64> = (0..padded * stride).map(number).collect();
            let mut slices = Slices::zeros(grid).half;
            let mut found = slices.index_axis_mut(Axis(0), 0);
            transform.slice(&fine, 2.0, &mut transform.workspace(), found.view_mut());
            for ((m, n), found) in found.indexed_iter() {
                let nu = n as f64 - grid.nu.half as f64;
                let at = |k: f64, cells: usize| kernel.transform(k / cells as f64);
                let scale = at(m as f64, rows) * at(nu, columns) / 2.0;
                let period = (n + columns - grid.nu.half) % columns;
                let off = found * scale - plain(&fine, placement, TAPS / 2 - 1, [m, period]);
                // The limit covers the rounding errors of sums of up to 56 numbers with a total of
                // about 4, and of 38 numbers with a total of about 13.
                assert!(modulus(off) < 5e-14, "{rows} × {columns}, {m}, {nu}: {off}");
            }
        }
    }
}
