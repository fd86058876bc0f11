//! The discrete Fourier transform of eight columns side by side.
//!
//! Libraries choose algorithms by the processor and take sines from the machine's C library, so
//! their last digits differ from one machine to the next. These do not.

use crate::portable::root_of_unity;
use fearless_simd::{Level, Simd, dispatch, f64x8, prelude::*};

/// Columns that are transformed at a time.
pub const COLUMNS: usize = 8;

/// A row of eight complex columns.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// Real parts.
    pub re: [f64; COLUMNS],
    /// Imaginary parts.
    pub im: [f64; COLUMNS],
}

/// The plan of F_k = Σ f_j e^(−2πi j k/n) over n rows, without a factor in front.
///
/// Stockham's order (Cochran and others 1967, *What is the fast Fourier transform?*): each stage
/// takes one factor of n and leaves its output sorted. Factors 4 and 2 have their own code; an odd
/// factor p costs p² operations. Products and sums are rounded one by one, so that every SIMD level
/// gives the same bits.
///
/// Error: about 10⁻¹⁶ relative to the root mean square of F.
#[derive(Clone, Debug)]
pub struct Fft {
    length: usize,
    stages: Vec<Stage>,
    level: Level,
}

/// One factor of the length.
#[derive(Clone, Debug)]
struct Stage {
    radix: usize,
    /// Rows that a stage before has put next to one another.
    stride: usize,
    /// e^(−2πi q l/(radix · rest)) for q below `rest`, the product of later factors, and l below
    /// the radix; [q, l].
    turns: Vec<[f64; 2]>,
    /// e^(−2πi k/radix).
    roots: Vec<[f64; 2]>,
}

/// Eight complex numbers.
type Lanes<S> = [f64x8<S>; 2];

impl Fft {
    /// The transform of columns of `length` numbers.
    ///
    /// # Panics
    ///
    /// When `length` is zero.
    #[must_use]
    pub fn new(length: usize) -> Self {
        Self::at_level(length, Level::new())
    }

    /// The same with the SIMD level given.
    fn at_level(length: usize, level: Level) -> Self {
        assert!(length > 0, "a transform of nothing");
        let mut stages = Vec::new();
        let (mut rest, mut stride) = (length, 1);
        while rest > 1 {
            let radix = factor(rest);
            rest /= radix;
            let pairs = (0..rest).flat_map(|q| (0..radix).map(move |l| q * l));
            stages.push(Stage {
                radix,
                stride,
                turns: pairs.map(|i| root_of_unity(i, radix * rest)).collect(),
                roots: (0..radix).map(|k| root_of_unity(k, radix)).collect(),
            });
            stride *= radix;
        }
        Self {
            length,
            stages,
            level,
        }
    }

    /// Numbers of a column.
    #[must_use]
    pub fn length(&self) -> usize {
        self.length
    }

    /// Transforms the columns of `rows`, by means of as many rows of scratch memory.
    ///
    /// # Panics
    ///
    /// When either does not hold [`length`](Self::length) rows.
    pub fn forward(&self, rows: &mut [Row], scratch: &mut [Row]) {
        assert_eq!([rows.len(), scratch.len()], [self.length; 2]);
        let (mut from, mut to) = (&mut *rows, &mut *scratch);
        for stage in &self.stages {
            dispatch!(self.level, simd => stage.run(simd, from, to));
            (from, to) = (to, from);
        }
        if self.stages.len() % 2 == 1 {
            rows.copy_from_slice(scratch);
        }
    }
}

/// The next factor taken out of `n` > 1: 4, 2, or the smallest odd one.
fn factor(n: usize) -> usize {
    let divides = |f: &usize| n.is_multiple_of(*f);
    [4, 2]
        .into_iter()
        .chain((3..).step_by(2))
        .find(divides)
        .unwrap_or(n)
}

impl Stage {
    #[inline(always)]
    fn run<S: Simd>(&self, simd: S, from: &[Row], to: &mut [Row]) {
        match self.radix {
            2 => self.butterflies(simd, from, to, [[f64x8::splat(simd, 0.0); 2]; 2], two),
            4 => self.butterflies(simd, from, to, [[f64x8::splat(simd, 0.0); 2]; 4], four),
            p => {
                let zero = f64x8::splat(simd, 0.0);
                let (mut sums, mut output) = (vec![[zero; 2]; p], vec![[zero; 2]; p]);
                self.butterflies(simd, from, to, vec![[zero; 2]; p], |simd, x| {
                    self.odd(simd, x, &mut sums, &mut output);
                });
            }
        }
    }

    /// Gathers rows a distance apart, lets `butterfly` transform them in place, turns them by their
    /// phases and puts them next to one another. `x` is memory for as many rows as the radix.
    #[inline(always)]
    fn butterflies<S: Simd, X: AsMut<[Lanes<S>]>>(
        &self,
        simd: S,
        from: &[Row],
        to: &mut [Row],
        mut x: X,
        mut butterfly: impl FnMut(S, &mut X),
    ) {
        let apart = from.len() / self.radix;
        let groups = to.chunks_exact_mut(self.radix * self.stride);
        for ((q, group), turns) in groups.enumerate().zip(self.turns.chunks_exact(self.radix)) {
            for j in 0..self.stride {
                for (k, x) in x.as_mut().iter_mut().enumerate() {
                    let row = &from[q * self.stride + j + k * apart];
                    *x = [&row.re, &row.im].map(|part| f64x8::from_slice(simd, part));
                }
                butterfly(simd, &mut x);
                for (l, ([re, im], [cos, sin])) in x.as_mut().iter().zip(turns).enumerate() {
                    let row = &mut group[l * self.stride + j];
                    (*re * *cos - *im * *sin).store_slice(&mut row.re);
                    (*re * *sin + *im * *cos).store_slice(&mut row.im);
                }
            }
        }
    }

    /// F_l = x₀ + Σ (x_k + x_{p−k}) Re r + i (x_k − x_{p−k}) Im r over k < p/2, r = e^(−2πi kl/p).
    #[inline(always)]
    fn odd<S: Simd>(
        &self,
        simd: S,
        x: &mut [Lanes<S>],
        sums: &mut [Lanes<S>],
        output: &mut [Lanes<S>],
    ) {
        let p = self.radix;
        for k in 1..=p / 2 {
            let [a, b] = [x[k], x[p - k]];
            sums[k] = [a[0] + b[0], a[1] + b[1]];
            sums[p - k] = [a[0] - b[0], a[1] - b[1]];
        }
        for (l, output) in output.iter_mut().enumerate() {
            let mut even = x[0];
            let mut odd = [f64x8::splat(simd, 0.0); 2];
            for k in 1..=p / 2 {
                let [cos, sin] = self.roots[k * l % p];
                for part in 0..2 {
                    even[part] += sums[k][part] * cos;
                    odd[part] += sums[p - k][part] * sin;
                }
            }
            *output = [even[0] - odd[1], even[1] + odd[0]];
        }
        x.copy_from_slice(output);
    }
}

#[inline(always)]
fn two<S: Simd>(_: S, x: &mut [Lanes<S>; 2]) {
    let [a, b] = *x;
    *x = [[a[0] + b[0], a[1] + b[1]], [a[0] - b[0], a[1] - b[1]]];
}

#[inline(always)]
fn four<S: Simd>(_: S, x: &mut [Lanes<S>; 4]) {
    let [a, b, c, d] = *x;
    let even = [[a[0] + c[0], a[1] + c[1]], [a[0] - c[0], a[1] - c[1]]];
    let odd = [[b[0] + d[0], b[1] + d[1]], [b[0] - d[0], b[1] - d[1]]];
    *x = [
        [even[0][0] + odd[0][0], even[0][1] + odd[0][1]],
        [even[1][0] + odd[1][1], even[1][1] - odd[1][0]],
        [even[0][0] - odd[0][0], even[0][1] - odd[0][1]],
        [even[1][0] - odd[1][1], even[1][1] + odd[1][0]],
    ];
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Stream, unit, words};
    use crate::{Complex, cis, modulus};
    use std::f64::consts::TAU;

    fn rows(length: usize) -> Vec<Row> {
        let number = |i: usize| unit(words(3, Stream::Photon, i as u64, 0)[0]) - 0.5;
        let row = |i: usize| Row {
            re: std::array::from_fn(|c| number(16 * i + c)),
            im: std::array::from_fn(|c| number(16 * i + 8 + c)),
        };
        (0..length).map(row).collect()
    }

    fn forward(fft: &Fft, mut rows: Vec<Row>) -> Vec<Row> {
        let mut scratch = rows.clone();
        fft.forward(&mut rows, &mut scratch);
        rows
    }

    #[test]
    fn it_is_the_plain_sum() {
        for n in (1..41).chain([48, 49, 60, 90, 128, 187]) {
            let input = rows(n);
            let output = forward(&Fft::new(n), input.clone());
            for column in [0, 5] {
                for (k, found) in output.iter().enumerate() {
                    let term = |(j, row): (usize, &Row)| {
                        let phase = -TAU * (j * k % n) as f64 / n as f64;
                        Complex::new(row.re[column], row.im[column]) * cis(phase)
                    };
                    let plain: Complex = input.iter().enumerate().map(term).sum();
                    let off = Complex::new(found.re[column], found.im[column]) - plain;
                    // Rounding of the plain sum.
                    assert!(modulus(off) < 1e-15 * n as f64, "{n}, {k}: {off}");
                }
            }
        }
    }

    #[test]
    fn every_level_gives_the_same_bits() {
        for n in [16, 30, 77] {
            let best = forward(&Fft::new(n), rows(n));
            assert_eq!(forward(&Fft::at_level(n, Level::baseline()), rows(n)), best);
        }
    }
}
