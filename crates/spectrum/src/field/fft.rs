use etendue_field::Complex;
use etendue_field::fft::{COLUMNS, Fft, Row};
use rayon::prelude::*;

/// Consecutive columns of one task along the first axis.
const BAND: usize = 512;

/// The plan of a 4D Fourier transform of real numbers, in place and on the threads of the current rayon pool.
///
/// F[a, b, c, d] = Σ f[i, j, k, l] e^(−2πi (a i/n₀ + b j/n₁ + c k/n₂ + d l/n₃)), without a factor in front, for
/// d = 0 … n₃/2; the rest are conjugates.
///
/// The array is [n₀, n₁, n₂, [`row`](Self::row)] complex numbers, C order. Before the transform a row holds
/// n₃ reals, two to a complex number (real part first) and what is left over unused, as FFTW's in-place transforms of
/// reals have it. See [`real`] and [`real_mut`].
///
/// Two rows of reals are the real and imaginary parts of one complex transform. Along the other axes, columns are
/// gathered eight at a time, transformed and put back. Every one-dimensional transform is the work of
/// one thread, so the bits do not depend on how many there are. Nor do they on the processor: see [`Fft`].
///
/// Error: that of the one-dimensional transforms, about 10⁻¹⁶ relative to the root mean square of F.
#[derive(Clone, Debug)]
pub struct RealFft4 {
    shape: [usize; 4],
    along: [Fft; 4],
}

/// The real number `index` of a row that has not been transformed yet.
#[inline]
#[must_use]
pub fn real(row: &[Complex], index: usize) -> f64 {
    let pair = &row[index / 2];
    if index.is_multiple_of(2) {
        pair.re
    } else {
        pair.im
    }
}

/// The place of the real number `index` in a row.
#[inline]
pub fn real_mut(row: &mut [Complex], index: usize) -> &mut f64 {
    let pair = &mut row[index / 2];
    if index.is_multiple_of(2) {
        &mut pair.re
    } else {
        &mut pair.im
    }
}

/// What a thread works in: eight columns, and scratch memory for their transform.
struct Memory {
    eight: Vec<Row>,
    scratch: Vec<Row>,
}

impl RealFft4 {
    /// The transform of arrays of `shape`.
    ///
    /// # Panics
    ///
    /// When an axis is empty.
    #[must_use]
    pub fn new(shape: [usize; 4]) -> Self {
        Self {
            shape,
            along: shape.map(Fft::new),
        }
    }

    /// The lengths of the axes.
    #[must_use]
    pub fn shape(&self) -> [usize; 4] {
        self.shape
    }

    /// Complex numbers of a row, n₃/2 + 1.
    #[must_use]
    pub fn row(&self) -> usize {
        self.shape[3] / 2 + 1
    }

    /// Complex numbers of the array.
    #[must_use]
    pub fn size(&self) -> usize {
        let [n0, n1, n2, _] = self.shape;
        n0 * n1 * n2 * self.row()
    }

    /// An array for [`forward`](Self::forward) from reals in C order.
    ///
    /// # Panics
    ///
    /// When `reals` does not hold n₀ n₁ n₂ n₃ numbers.
    #[must_use]
    pub fn padded(&self, reals: &[f64]) -> Vec<Complex> {
        let [n, row] = [self.shape[3], self.row()];
        assert_eq!(
            reals.len(),
            self.shape.iter().product::<usize>(),
            "reals of an array of {:?}",
            self.shape
        );
        let pair = |i: usize| {
            let reals = &reals[i / row * n..][..n];
            let at = |l: usize| reals.get(l).copied().unwrap_or_default();
            Complex::new(at(2 * (i % row)), at(2 * (i % row) + 1))
        };
        // On all threads: most of the time goes into touching new memory.
        let all = (0..self.size()).into_par_iter().with_min_len(1 << 14);
        all.map(pair).collect()
    }

    /// Transforms reals to their spectrum.
    ///
    /// # Panics
    ///
    /// When `data` does not hold [`size`](Self::size) numbers.
    pub fn forward(&self, data: &mut [Complex]) {
        assert_eq!(
            data.len(),
            self.size(),
            "numbers of an array of {:?}",
            self.shape
        );
        let [_, n1, n2, _] = self.shape;
        let plane = n2 * self.row();
        // Three axes while a block is in the cache.
        data.par_chunks_exact_mut(n1 * plane).for_each_init(
            || self.memory(),
            |memory, block| {
                for plane in block.chunks_exact_mut(plane) {
                    self.rows(plane, memory);
                    columns(plane, &self.along[2], memory);
                }
                columns(block, &self.along[1], memory);
            },
        );
        self.first_axis(data, n1 * plane);
    }

    fn memory(&self) -> Memory {
        let longest = self.shape.into_iter().max().unwrap_or_default();
        Memory {
            eight: vec![Row::default(); longest],
            scratch: vec![Row::default(); longest],
        }
    }

    /// Transforms rows of reals, sixteen at a time as eight complex ones: with Z the transform of a + ib, those of a
    /// and ib are the parts (Z(m) ± conj Z(−m))/2 of it.
    fn rows(&self, rows: &mut [Complex], memory: &mut Memory) {
        let n = self.shape[3];
        let [z, scratch] = [&mut memory.eight, &mut memory.scratch].map(|v| &mut v[..n]);
        for group in rows.chunks_mut(2 * COLUMNS * self.row()) {
            for (c, pair) in group.chunks(2 * self.row()).enumerate() {
                let (a, b) = pair.split_at(self.row());
                for (l, z) in z.iter_mut().enumerate() {
                    z.re[c] = real(a, l);
                    // The last of an odd number of rows goes alone.
                    z.im[c] = if b.is_empty() { 0.0 } else { real(b, l) };
                }
            }
            self.along[3].forward(z, scratch);
            for (c, pair) in group.chunks_mut(2 * self.row()).enumerate() {
                let (a, b) = pair.split_at_mut(self.row());
                for (m, a) in a.iter_mut().enumerate() {
                    let [z, mirrored] =
                        [m, (n - m) % n].map(|m| [0.5 * z[m].re[c], 0.5 * z[m].im[c]]);
                    *a = Complex::new(z[0] + mirrored[0], z[1] - mirrored[1]);
                    if let Some(b) = b.get_mut(m) {
                        *b = Complex::new(z[1] + mirrored[1], mirrored[0] - z[0]);
                    }
                }
            }
        }
    }

    /// Transforms along the first axis: [n₀, `inner`] numbers, cut into bands of columns.
    fn first_axis(&self, data: &mut [Complex], inner: usize) {
        let mut bands: Vec<Vec<&mut [Complex]>> = Vec::new();
        bands.resize_with(inner.div_ceil(BAND), Vec::new);
        for row in data.chunks_exact_mut(inner) {
            for (band, part) in bands.iter_mut().zip(row.chunks_mut(BAND)) {
                band.push(part);
            }
        }
        bands.into_par_iter().for_each_init(
            || self.memory(),
            |memory, mut band| transform_columns(&mut band, &self.along[0], memory),
        );
    }
}

/// Transforms the columns of a matrix that lies in one piece.
fn columns(data: &mut [Complex], fft: &Fft, memory: &mut Memory) {
    let inner = data.len() / fft.length();
    let mut rows: Vec<_> = data.chunks_exact_mut(inner).collect();
    transform_columns(&mut rows, fft, memory);
}

/// Transforms the columns of a matrix given by its rows.
fn transform_columns(rows: &mut [&mut [Complex]], fft: &Fft, memory: &mut Memory) {
    let n = rows.len();
    let [eight, scratch] = [&mut memory.eight, &mut memory.scratch].map(|v| &mut v[..n]);
    let width = rows[0].len();
    for start in (0..width).step_by(COLUMNS) {
        let columns = start..width.min(start + COLUMNS);
        for (row, eight) in rows.iter().zip(eight.iter_mut()) {
            for (c, value) in row[columns.clone()].iter().enumerate() {
                (eight.re[c], eight.im[c]) = (value.re, value.im);
            }
        }
        fft.forward(eight, scratch);
        for (row, eight) in rows.iter_mut().zip(eight.iter()) {
            for (c, value) in row[columns.clone()].iter_mut().enumerate() {
                *value = Complex::new(eight.re[c], eight.im[c]);
            }
        }
    }
}
