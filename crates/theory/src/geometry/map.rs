//! Affine maps of rays.

use super::SpectrumMap;
use super::matrix::{self, Matrix, congruent, diagonal, plus, times, transpose};
use etendue_field::Complex;

/// An affine map of rays, z' = A z + t, that preserves radiance (docs/theory.md (1)).
///
/// Coordinates are positions, then slopes or angles: (x, u) for N = 2, (x, y, u, v) for N = 4.
/// Other values of N have no constructors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AffineMap<const N: usize> {
    /// The matrix A, as rows.
    pub matrix: Matrix<N>,
    /// The offset t.
    pub offset: [f64; N],
}

/// The finite differences that estimate a map have this step, in metres and radians.
const STEP: f64 = 1e-5;

impl<const N: usize> AffineMap<N> {
    /// The affine map that is tangent to another map of rays, at the ray z = 0. It is
    /// computed by differences of fourth order and is accurate to about 10⁻¹⁰ per metre and radian.
    /// Returns `None` if a ray near z = 0 does not arrive.
    pub(crate) fn touching(map: impl Fn([f64; N]) -> Option<[f64; N]>) -> Option<Self> {
        Self::touching_by(STEP, map)
    }

    /// The tangent map by differences with the given step.
    fn touching_by(step: f64, map: impl Fn([f64; N]) -> Option<[f64; N]>) -> Option<Self> {
        let offset = map([0.0; N])?;
        let mut matrix: Matrix<N> = [[0.0; N]; N];
        for column in 0..N {
            let at = |steps: f64| {
                let mut z = [0.0; N];
                z[column] = steps * step;
                map(z)
            };
            let [a, b, c, d] = [at(-2.0)?, at(-1.0)?, at(1.0)?, at(2.0)?];
            for row in 0..N {
                let sum = a[row] - 8.0 * b[row] + 8.0 * c[row] - d[row];
                matrix[row][column] = sum / (12.0 * step);
            }
        }
        Some(Self { matrix, offset })
    }

    /// Compares this map with another map of rays near the ray z = 0. Returns the distance, as
    /// [`apart`](Self::apart) defines it, between this map and the affine map that is tangent to
    /// the other map at this ray. The estimated error of the finite differences is subtracted from
    /// the distance, because this error is noticeable if the other map is strongly curved.
    pub(crate) fn off_touching(
        &self,
        map: impl Fn([f64; N]) -> Option<[f64; N]>,
        half: &[f64; N],
    ) -> Option<f64> {
        let fine = Self::touching_by(STEP, &map)?;
        let open = fine.apart(&Self::touching_by(2.0 * STEP, &map)?, half);
        Some((self.apart(&fine, half) - open).max(0.0))
    }

    /// The distance between this map and another map, in half-widths of a window. The
    /// distance is the largest difference between the images of a ray under the two maps, over all
    /// rays that either map takes into the window.
    pub(crate) fn apart(&self, other: &Self, half: &[f64; N]) -> f64 {
        let mut most = 0.0_f64;
        for (row, half) in half.iter().enumerate() {
            most = most.max((self.offset[row] - other.offset[row]).abs() / half);
        }
        for column in 0..N {
            let [a, b] = [self, other].map(|map| {
                let rows = map.matrix.iter().zip(half);
                rows.map(|(row, half)| row[column] / half)
                    .collect::<Vec<_>>()
            });
            let both = a.iter().chain(&b).map(|entry| entry.abs());
            let largest = both.fold(f64::MIN_POSITIVE, f64::max);
            let off = a.iter().zip(&b).map(|(a, b)| (a - b).abs() / largest);
            most = off.fold(most, f64::max);
        }
        most
    }

    /// The map z' = A z.
    #[must_use]
    pub const fn linear(matrix: Matrix<N>) -> Self {
        let offset = [0.0; N];
        Self { matrix, offset }
    }

    /// The identity map.
    #[must_use]
    pub fn identity() -> Self {
        Self::linear(diagonal([1.0; N]))
    }

    /// The map that applies this map first and then `next`.
    #[must_use]
    pub fn then(&self, next: &Self) -> Self {
        Self {
            matrix: matrix::product(&next.matrix, &self.matrix),
            offset: next.apply(self.offset),
        }
    }

    /// The inverse map; `None` if an elimination of A meets a pivot that is zero or not
    /// finite.
    #[must_use]
    pub fn inverse(&self) -> Option<Self> {
        let inverse = matrix::inverse(&self.matrix)?;
        Some(Self {
            matrix: inverse,
            offset: times(&inverse, &self.offset).map(|t| -t),
        })
    }

    /// Returns det A, the factor by which volumes of ray space grow. The determinant is negative if
    /// the map reverses orientation, as the step onto a surface does.
    #[must_use]
    pub fn det(&self) -> f64 {
        matrix::determinant(&self.matrix)
    }

    /// The image A z + t of a ray z.
    #[must_use]
    pub fn apply(&self, ray: [f64; N]) -> [f64; N] {
        plus(&times(&self.matrix, &ray), &self.offset)
    }

    /// The effect of the map on spectra, which has the factor |det A|, the matrix Aᵀ and
    /// the phase vector t.
    #[must_use]
    pub fn spectrum_map(&self) -> SpectrumMap<N> {
        SpectrumMap {
            factor: self.det().abs(),
            matrix: transpose(&self.matrix),
            phase: self.offset,
        }
    }

    /// The spectrum at Ω after the map, |det A| e^(−2πi Ω·t) L(Aᵀ Ω), for a field with the
    /// spectrum L before it.
    ///
    /// Frequencies are in cycles per unit of each coordinate.
    #[must_use]
    pub fn spectrum(&self, omega: [f64; N], before: &dyn Fn([f64; N]) -> Complex) -> Complex {
        self.spectrum_map().spectrum(omega, before)
    }

    /// The covariance of rays after the map, A S Aᵀ, for rays with the covariance S before
    /// it.
    #[must_use]
    pub fn covariance(&self, before: &Matrix<N>) -> Matrix<N> {
        congruent(&self.matrix, before)
    }

    /// The covariance of |L| or |L|² after the map, A⁻ᵀ S A⁻¹, where S is this covariance
    /// before the map. Returns `None` as for [`inverse`](Self::inverse).
    #[must_use]
    pub fn spectral_covariance(&self, before: &Matrix<N>) -> Option<Matrix<N>> {
        let inverse = matrix::inverse(&self.matrix)?;
        Some(congruent(&transpose(&inverse), before))
    }

    /// The largest entry of |Aᵀ J A − r J|, which is zero if the map conserves étendue. J
    /// is [[0, 1], [−1, 0]] in blocks, and r is the index of refraction before the map divided by
    /// the index after the map.
    ///
    /// The result is zero between two planes perpendicular to the light, whatever is between them.
    /// In 2D the conserved quantity is n dx du, and the result is |det A − r|. In 4D the conserved
    /// quantity is the Lagrange invariant of every pair of rays. The result is not zero for a
    /// single map onto a surface or off a surface, because each such map changes dx by a cosine.
    #[must_use]
    pub fn symplectic_defect(&self, index_ratio: f64) -> f64 {
        let half = N / 2;
        let j = |i: usize, k: usize| {
            f64::from(u8::from(i + half == k)) - f64::from(u8::from(i == k + half))
        };
        let kept = congruent(&transpose(&self.matrix), &matrix::from_fn(j));
        let entries = (0..N).flat_map(|i| (0..N).map(move |k| (i, k)));
        entries
            .map(|(i, k)| (kept[i][k] - index_ratio * j(i, k)).abs())
            // Returns the larger of two numbers, or NaN if one of them is NaN.
            .fold(0.0, |most, x| if most >= x { most } else { x })
    }
}

impl<const N: usize> SpectrumMap<N> {
    /// The effect on rays, z' = A z + t, where A is the transpose of the matrix and t is
    /// the phase.
    #[must_use]
    pub fn rays(&self) -> AffineMap<N> {
        AffineMap {
            matrix: transpose(&self.matrix),
            offset: self.phase,
        }
    }
}

impl AffineMap<4> {
    /// The map that applies one map to (x, u) and another to (y, v).
    #[must_use]
    pub fn sections(x: &AffineMap<2>, y: &AffineMap<2>) -> Self {
        let [[x0, u0], [y0, v0]] = [x.offset, y.offset];
        Self {
            matrix: matrix::sections(&x.matrix, &y.matrix),
            offset: [x0, y0, u0, v0],
        }
    }
}
