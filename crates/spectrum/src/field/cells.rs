//! Sums weighted rays on a 4D grid.

use super::spectrum::FieldSpectrum;
use super::spline::{taps, transform};
use etendue_field::{Assignment, Complex, FieldGrid, TwoPlane};
use etendue_transform::{RealFft4, real, real_mut};
use ndarray::Array4;
use rayon::prelude::*;

/// The plan for summing weighted rays on a 4D grid and transforming the grid to its spectrum.
#[derive(Debug)]
pub struct FieldTransform {
    grid: FieldGrid,
    assignment: Assignment,
    fft: RealFft4,
    /// The correction factors along each axis, at each index of the transform.
    factors: [Vec<f64>; 4],
}

impl FieldTransform {
    /// The plan for `grid`.
    #[must_use]
    pub fn new(grid: FieldGrid, assignment: Assignment) -> Self {
        let factor = |axis: usize, i: usize| {
            let harmonic = grid.harmonic(axis, i);
            // The origin is at cell n/2. Cell 0, the phase reference of the transform, is half a
            // period from the origin.
            let sign = if harmonic % 2 == 0 { 1.0 } else { -1.0 };
            sign / transform(assignment, harmonic as f64 / grid.cells[axis] as f64)
        };
        let axes = [0, 1, 2, 3];
        Self {
            grid,
            assignment,
            fft: RealFft4::new(grid.cells),
            factors: axes.map(|axis| (0..grid.cells[axis]).map(|i| factor(axis, i)).collect()),
        }
    }

    /// An empty grid.
    #[must_use]
    pub fn cells(&self) -> FieldCells {
        FieldCells {
            grid: self.grid,
            assignment: self.assignment,
            row: self.fft.row(),
            data: vec![Complex::ZERO; self.fft.size()],
        }
    }

    /// The spectrum of the cells, and reuses their memory.
    ///
    /// # Panics
    ///
    /// Panics if `cells` belongs to another plan.
    #[must_use]
    pub fn spectrum(&self, cells: FieldCells) -> FieldSpectrum {
        assert_eq!((cells.grid, cells.assignment), (self.grid, self.assignment));
        let mut data = cells.data;
        self.fft.forward(&mut data);
        self.compensate(&mut data);
        let [nx, ny, nu, _] = self.grid.cells;
        let shape = (nx, ny, nu, self.fft.row());
        let values = Array4::from_shape_vec(shape, data).expect("the size of the grid");
        FieldSpectrum {
            grid: self.grid,
            assignment: self.assignment,
            values,
        }
    }

    /// Divides the spectrum by the transform of the spline, and moves the phase reference to the
    /// origin.
    fn compensate(&self, data: &mut [Complex]) {
        let [_, ny, nu, _] = self.grid.cells;
        let row = self.fft.row();
        let [fx, fy, fu, fv] = &self.factors;
        data.par_chunks_exact_mut(row)
            .enumerate()
            .with_min_len(64)
            .for_each(|(i, values)| {
                let factor = fx[i / (ny * nu)] * fy[i / nu % ny] * fu[i % nu];
                for (value, fv) in values.iter_mut().zip(fv) {
                    *value *= factor * fv;
                }
            });
    }
}

/// A sum of weighted rays on a 4D grid.
///
/// The caller multiplies each ray by the window and by its weight in radiance space. Each cell
/// contains Σ w · share, where `share` is the share of a ray that is assigned to the cell. Rays are
/// added in order.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldCells {
    grid: FieldGrid,
    assignment: Assignment,
    /// Number of complex numbers in a row.
    row: usize,
    /// The cells, in the layout of [`RealFft4`].
    data: Vec<Complex>,
}

impl FieldCells {
    /// Adds a ray, which must lie inside the box of the grid.
    #[inline]
    pub fn deposit(&mut self, ray: &TwoPlane, weight: f64) {
        match self.assignment {
            Assignment::Nearest => self.share::<1>(ray, weight),
            Assignment::Cic => self.share::<2>(ray, weight),
            Assignment::Tsc => self.share::<3>(ray, weight),
        }
    }

    #[inline]
    fn share<const P: usize>(&mut self, ray: &TwoPlane, weight: f64) {
        let [nx, ny, nu, nv] = self.grid.cells;
        let [x, y, u, v] = self.grid.position(ray);
        let (xs, wx) = taps::<P>(x, nx);
        let (ys, wy) = taps::<P>(y, ny);
        let (us, wu) = taps::<P>(u, nu);
        let (vs, wv) = taps::<P>(v, nv);
        for (x, wx) in xs.iter().zip(wx) {
            for (y, wy) in ys.iter().zip(wy) {
                for (u, wu) in us.iter().zip(wu) {
                    let start = ((x * ny + y) * nu + u) * self.row;
                    let row = &mut self.data[start..start + self.row];
                    let weight = weight * wx * wy * wu;
                    for (v, wv) in vs.iter().zip(wv) {
                        *real_mut(row, *v) += weight * wv;
                    }
                }
            }
        }
    }

    /// Adds another sum of rays, cell by cell.
    pub(crate) fn add(&mut self, other: &Self) {
        self.data
            .par_iter_mut()
            .zip(&other.data)
            .with_min_len(1 << 14)
            .for_each(|(a, b)| *a += b);
    }

    /// The light field at the cells' centres: Σ w · share / (volume of a cell), [x, y, u,
    /// v], all ascending.
    #[must_use]
    pub fn field(&self) -> Array4<f64> {
        let volume = self.grid.cell_volume();
        let mut field = Array4::zeros(self.grid.cells);
        for (mut out, row) in field
            .rows_mut()
            .into_iter()
            .zip(self.data.chunks_exact(self.row))
        {
            for (l, out) in out.iter_mut().enumerate() {
                *out = real(row, l) / volume;
            }
        }
        field
    }
}
