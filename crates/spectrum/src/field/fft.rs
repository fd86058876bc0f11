use rayon::prelude::*;
use rustfft::num_complex::Complex as Number;
use rustfft::{Fft, FftNum, FftPlanner, FftPlannerScalar};
use std::fmt;
use std::sync::Arc;

/// Consecutive columns of one task along the first axis.
const BAND: usize = 512;

/// Columns that are transformed together: gathered next to one another, they use the whole of each cache line. 256
/// bytes of a row did best, 16 columns of f64 and 32 of f32.
const fn columns_at_once<T>() -> usize {
    256 / size_of::<Number<T>>()
}

/// Which one-dimensional transforms are used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kernels {
    /// The same on every processor, to the bit.
    Portable,
    /// The best the processor at hand offers. Another processor may round otherwise.
    Native,
}

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
/// gathered a few at a time, transformed and put back. Every one-dimensional transform is the work of
/// one thread, so the bits do not depend on how many there are.
///
/// Error: that of the one-dimensional transforms, about 10⁻¹⁶ relative to the root mean square of F for f64.
pub struct RealFft4<T: FftNum> {
    shape: [usize; 4],
    along: [Arc<dyn Fft<T>>; 4],
}

impl<T: FftNum> fmt::Debug for RealFft4<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RealFft4")
            .field("shape", &self.shape)
            .finish_non_exhaustive()
    }
}

/// The real number `index` of a row that has not been transformed yet.
#[inline]
#[must_use]
pub fn real<T: Copy>(row: &[Number<T>], index: usize) -> T {
    let pair = &row[index / 2];
    if index.is_multiple_of(2) {
        pair.re
    } else {
        pair.im
    }
}

/// The place of the real number `index` in a row.
#[inline]
pub fn real_mut<T>(row: &mut [Number<T>], index: usize) -> &mut T {
    let pair = &mut row[index / 2];
    if index.is_multiple_of(2) {
        &mut pair.re
    } else {
        &mut pair.im
    }
}

/// What a thread works in.
struct Scratch<T> {
    columns: Vec<Number<T>>,
    fft: Vec<Number<T>>,
}

impl<T: FftNum> RealFft4<T> {
    /// The transform of arrays of `shape`.
    ///
    /// # Panics
    ///
    /// When an axis is empty.
    #[must_use]
    pub fn new(shape: [usize; 4], kernels: Kernels) -> Self {
        assert!(
            shape.iter().all(|n| *n > 0),
            "an axis of {shape:?} is empty"
        );
        let along = match kernels {
            Kernels::Portable => {
                let mut planner = FftPlannerScalar::new();
                shape.map(|n| planner.plan_fft_forward(n))
            }
            Kernels::Native => {
                let mut planner = FftPlanner::new();
                shape.map(|n| planner.plan_fft_forward(n))
            }
        };
        Self { shape, along }
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
    pub fn padded(&self, reals: &[T]) -> Vec<Number<T>> {
        let [n, row] = [self.shape[3], self.row()];
        assert_eq!(
            reals.len(),
            self.shape.iter().product::<usize>(),
            "reals of an array of {:?}",
            self.shape
        );
        let pair = |i: usize| {
            let reals = &reals[i / row * n..][..n];
            let at = |l: usize| reals.get(l).copied().unwrap_or_else(T::zero);
            Number::new(at(2 * (i % row)), at(2 * (i % row) + 1))
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
    pub fn forward(&self, data: &mut [Number<T>]) {
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
            || self.scratch(),
            |scratch, block| {
                for plane in block.chunks_exact_mut(plane) {
                    self.rows(plane, scratch);
                    columns(plane, &*self.along[2], scratch);
                }
                columns(block, &*self.along[1], scratch);
            },
        );
        self.first_axis(data, n1 * plane);
    }

    fn scratch(&self) -> Scratch<T> {
        let longest = self.shape.iter().max().copied().unwrap_or(0);
        let fft = self.along.iter().map(|fft| fft.get_inplace_scratch_len());
        Scratch {
            columns: vec![zero(); longest * columns_at_once::<T>()],
            fft: vec![zero(); fft.max().unwrap_or(0)],
        }
    }

    /// Transforms rows of reals, two at a time: with Z the transform of a + ib, those of a and ib are the parts
    /// (Z(m) ± conj Z(−m))/2 of it. The last of an odd number of rows goes alone.
    fn rows(&self, rows: &mut [Number<T>], scratch: &mut Scratch<T>) {
        let n = self.shape[3];
        let half = T::one() / (T::one() + T::one());
        let z = &mut scratch.columns[..n];
        for pair in rows.chunks_mut(2 * self.row()) {
            let (a, b) = pair.split_at_mut(self.row());
            for (l, z) in z.chunks_mut(2).enumerate() {
                let mate = b.get(l).copied().unwrap_or_else(zero);
                z[0] = Number::new(a[l].re, mate.re);
                if let Some(z) = z.get_mut(1) {
                    *z = Number::new(a[l].im, mate.im);
                }
            }
            self.along[3].process_with_scratch(z, &mut scratch.fft);
            for m in 0..a.len() {
                let (z, mirrored) = (z[m] * half, z[(n - m) % n].conj() * half);
                a[m] = z + mirrored;
                if let Some(b) = b.get_mut(m) {
                    let ib = z - mirrored;
                    *b = Number::new(ib.im, -ib.re);
                }
            }
        }
    }

    /// Transforms along the first axis: [n₀, `inner`] numbers, cut into bands of columns.
    fn first_axis(&self, data: &mut [Number<T>], inner: usize) {
        let mut bands: Vec<Vec<&mut [Number<T>]>> = Vec::new();
        bands.resize_with(inner.div_ceil(BAND), Vec::new);
        for row in data.chunks_exact_mut(inner) {
            for (band, part) in bands.iter_mut().zip(row.chunks_mut(BAND)) {
                band.push(part);
            }
        }
        bands.into_par_iter().for_each_init(
            || self.scratch(),
            |scratch, mut band| {
                transform_columns(&mut band, &*self.along[0], scratch);
            },
        );
    }
}

fn zero<T: FftNum>() -> Number<T> {
    Number::new(T::zero(), T::zero())
}

/// Transforms the columns of a matrix that lies in one piece.
fn columns<T: FftNum>(data: &mut [Number<T>], fft: &dyn Fft<T>, scratch: &mut Scratch<T>) {
    let inner = data.len() / fft.len();
    let mut rows: Vec<_> = data.chunks_exact_mut(inner).collect();
    transform_columns(&mut rows, fft, scratch);
}

/// Transforms the columns of a matrix given by its rows.
fn transform_columns<T: FftNum>(
    rows: &mut [&mut [Number<T>]],
    fft: &dyn Fft<T>,
    scratch: &mut Scratch<T>,
) {
    let n = rows.len();
    let width = rows[0].len();
    for start in (0..width).step_by(columns_at_once::<T>()) {
        let count = columns_at_once::<T>().min(width - start);
        let block = &mut scratch.columns[..count * n];
        for (i, row) in rows.iter().enumerate() {
            for (c, value) in row[start..start + count].iter().enumerate() {
                block[c * n + i] = *value;
            }
        }
        fft.process_with_scratch(block, &mut scratch.fft);
        for (i, row) in rows.iter_mut().enumerate() {
            for (c, value) in row[start..start + count].iter_mut().enumerate() {
                *value = block[c * n + i];
            }
        }
    }
}
