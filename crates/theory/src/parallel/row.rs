//! Arithmetic along a row of frequencies.

use etendue_field::{Complex, SliceGrid, Slices, cis};
use ndarray::Axis;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// A row of frequencies with a common position frequency, in cycles per half-width.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrequencyRow {
    /// Frequency of position, which is the same for the complete row.
    pub(crate) position: f64,
    /// Spacing of the slope frequencies (n − half) · step, 0 ≤ n ≤ 2 half.
    pub(crate) step: f64,
    pub(crate) half: usize,
}

/// A row of complex numbers whose real and imaginary parts are stored separately, so that loops
/// over a row can be vectorised.
#[derive(Clone, Debug)]
pub(crate) struct ComplexRow {
    pub(crate) re: Vec<f64>,
    pub(crate) im: Vec<f64>,
}

impl ComplexRow {
    pub(crate) fn zeros(len: usize) -> Self {
        Self {
            re: vec![0.0; len],
            im: vec![0.0; len],
        }
    }
}

impl FrequencyRow {
    pub(crate) fn count(&self) -> usize {
        2 * self.half + 1
    }

    pub(crate) fn frequency(&self, n: usize) -> [f64; 2] {
        [self.position, (n as f64 - self.half as f64) * self.step]
    }

    /// Writes scale · exp(−2πi k·p) along the row to `to`. Starting at the middle of the row, each
    /// value is the previous value times a constant factor.
    pub(crate) fn exponentials(&self, p: [f64; 2], scale: impl Into<Complex>, to: &mut ComplexRow) {
        let middle = cis(-TAU * self.position * p[0]) * scale.into();
        let up = cis(-TAU * self.step * p[1]);
        let (mut above, mut below) = (middle, middle);
        (to.re[self.half], to.im[self.half]) = (middle.re, middle.im);
        for j in 1..=self.half {
            above *= up;
            below *= up.conj();
            (to.re[self.half + j], to.im[self.half + j]) = (above.re, above.im);
            (to.re[self.half - j], to.im[self.half - j]) = (below.re, below.im);
        }
    }
}

pub(crate) fn add_scaled(to: &mut [f64], values: &[f64], factor: f64) {
    for (t, v) in to.iter_mut().zip(values) {
        *t += v * factor;
    }
}

/// Adds the elementwise product a · b to a range of a row: to[range] += a · b.
pub(crate) fn add_product(
    to: &mut ComplexRow,
    range: std::ops::Range<usize>,
    a: &ComplexRow,
    b: &ComplexRow,
) {
    let re = to.re[range.clone()].iter_mut();
    let im = to.im[range].iter_mut();
    let a = a.re.iter().zip(&a.im);
    let b = b.re.iter().zip(&b.im);
    for (((re, im), (a_re, a_im)), (b_re, b_im)) in re.zip(im).zip(a).zip(b) {
        *re += a_re * b_re - a_im * b_im;
        *im += a_re * b_im + a_im * b_re;
    }
}

/// Computes slices by rows of constant (azimuth, ρ). `row` receives the cosine and the sine of the
/// azimuth, and ρ. Rows are computed in parallel, but each row by a single thread, so the result is
/// the same for any number of threads.
pub(crate) fn slices_by_rows(
    grid: &SliceGrid,
    row: impl Fn([f64; 2], f64) -> Vec<Complex> + Sync,
) -> Slices {
    let all = several_by_rows(grid, 1, |along, rho| vec![row(along, rho)]);
    all.into_iter().next().expect("one for each row")
}

/// Computes several slices as [`slices_by_rows`] does; `row` returns a row of each.
pub(crate) fn several_by_rows(
    grid: &SliceGrid,
    count: usize,
    row: impl Fn([f64; 2], f64) -> Vec<Vec<Complex>> + Sync,
) -> Vec<Slices> {
    let [azimuths, rows, _] = grid.half_shape();
    let values: Vec<Vec<Vec<Complex>>> = (0..azimuths * rows)
        .into_par_iter()
        .map(|i| {
            let (sin, cos) = libm::sincos(grid.azimuth(i / rows));
            row([cos, sin], (i % rows) as f64 * grid.rho.spacing)
        })
        .collect();
    let mut all = vec![Slices::zeros(*grid); count];
    for (i, each) in values.into_iter().enumerate() {
        for (slices, from) in all.iter_mut().zip(each) {
            let to = slices.half.index_axis_mut(Axis(0), i / rows);
            let to = to.index_axis_move(Axis(0), i % rows);
            to.into_iter().zip(from).for_each(|(to, from)| *to = from);
        }
    }
    all
}
