//! Spectral covariances, stored as pairs of matrices whose quotient is the covariance.

use crate::geometry::{
    AffineMap, Matrix, diagonal, from_fn, inverse, product, sum, times, transpose,
};
use std::f64::consts::PI;

/// The factor 8π² in S⁻¹ = 8π² C, where C is the covariance of |L|². (If C were the covariance
/// of |L|, the factor would be 4π².)
const POWER: f64 = 8.0 * PI * PI;

/// The covariance C of the power spectrum of a Gaussian light field over [ρx, ρy, νu, νv], in
/// cycles² per squared unit of the coordinates.
///
/// C is stored as P Q⁻¹. If light is unbounded along a coordinate, P is rank-deficient. If light
/// comes from a point or has a single direction, Q is rank-deficient. Operators handle
/// rank-deficient matrices without special cases or thresholds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpectralCovariance {
    p: Matrix<4>,
    q: Matrix<4>,
}

impl SpectralCovariance {
    /// The spectral covariance of light that is a Gaussian over (x, y, u, v) with the
    /// given variances, in squares of metres and slopes. A variance of zero represents a point or
    /// a single direction, and an infinite variance represents unbounded light.
    #[must_use]
    pub fn new(variance: [f64; 4]) -> Self {
        let is_flat = |s: f64| s == f64::INFINITY;
        Self {
            p: diagonal(variance.map(|s| if is_flat(s) { 0.0 } else { 1.0 })),
            q: diagonal(variance.map(|s| if is_flat(s) { 1.0 } else { POWER * s })),
        }
    }

    /// The spectral covariance for a matrix C.
    #[must_use]
    pub fn of(matrix: &Matrix<4>) -> Self {
        Self {
            p: *matrix,
            q: diagonal([1.0; 4]),
        }
    }

    /// A⁻ᵀ C A⁻¹, the covariance after a change z' = A z + t of ray coordinates. The offset
    /// does not affect the power spectrum. Returns `None` if A has no inverse.
    #[must_use]
    pub fn mapped(&self, map: &AffineMap<4>) -> Option<Self> {
        let back = transpose(&inverse(&map.matrix)?);
        Some(Self {
            p: product(&back, &self.p),
            q: product(&map.matrix, &self.q),
        })
    }

    /// C + W, the covariance after a product with a factor whose power spectrum has the
    /// covariance W.
    #[must_use]
    pub fn multiplied(&self, factor: &Matrix<4>) -> Self {
        Self {
            p: sum(&self.p, &product(factor, &self.q)),
            q: self.q,
        }
    }

    /// The covariance after a convolution of the light field with a Gaussian of covariance
    /// s, in squares of metres and radians. The convolution increases C⁻¹ by 8π² s. If the
    /// covariance s is zero, as for a mirror, C does not change.
    #[must_use]
    pub fn convolved(&self, kernel: &Matrix<4>) -> Self {
        let grown = product(kernel, &self.p).map(|row| row.map(|entry| POWER * entry));
        Self {
            p: self.p,
            q: sum(&self.q, &grown),
        }
    }

    /// The covariance after diffuse reflection. Diffuse reflection integrates light over
    /// all directions and spreads the result uniformly over directions, so only the spectrum at ν =
    /// 0 remains. The block of C⁻¹ for positions does not change, and C⁻¹ becomes infinite along
    /// both angles.
    #[must_use]
    pub fn diffused(&self) -> Self {
        // The columns of P and Q form pairs (C w, w). Pairs without angular frequency do not
        // change.
        let mut columns = [0, 1, 2, 3].map(|j| [&self.q, &self.p].map(|m| m.map(|row| row[j])));
        let mut goes = [false; 4];
        for row in [2, 3] {
            let size = |j: usize| columns[j][1][row].abs();
            let rest = (0..4).filter(|j| !goes[*j]);
            let Some(pivot) = rest.max_by(|a, b| size(*a).total_cmp(&size(*b))) else {
                break;
            };
            if size(pivot) <= 0.0 {
                // The light is already uniform along this angle, so nothing changes.
                continue;
            }
            goes[pivot] = true;
            let taken = columns[pivot];
            for j in (0..4).filter(|j| !goes[*j]) {
                let share = columns[j][1][row] / taken[1][row];
                columns[j] = [0, 1]
                    .map(|m| [0, 1, 2, 3].map(|i: usize| columns[j][m][i] - share * taken[m][i]));
                columns[j][1][row] = 0.0;
            }
        }
        let even = |[_, p]: [[f64; 4]; 2]| [[0.0, 0.0, p[2], p[3]], [0.0; 4]];
        let columns: [_; 4] = std::array::from_fn(|j| {
            if goes[j] {
                even(columns[j])
            } else {
                columns[j]
            }
        });
        Self {
            p: from_fn(|i, j| columns[j][1][i]),
            q: from_fn(|i, j| columns[j][0][i]),
        }
    }

    /// C. Returns `None` if the spectrum is unbounded, as for light from a point.
    #[must_use]
    pub fn matrix(&self) -> Option<Matrix<4>> {
        Some(symmetric(&product(&self.p, &inverse(&self.q)?)))
    }

    /// S, the covariance of the Gaussian light field, in squares of metres and slopes.
    /// Returns `None` if the field is unbounded.
    #[must_use]
    pub fn field(&self) -> Option<Matrix<4>> {
        let field = symmetric(&product(&self.q, &inverse(&self.p)?));
        Some(field.map(|row| row.map(|entry| entry / POWER)))
    }
}

/// Removes the asymmetry that rounding errors leave.
fn symmetric(a: &Matrix<4>) -> Matrix<4> {
    from_fn(|i, j| 0.5 * (a[i][j] + a[j][i]))
}

/// |L(Ω)|²/|L(0)|² of a Gaussian light field of covariance S: exp(−4π² Ωᵀ S Ω).
#[must_use]
pub fn power(field: &Matrix<4>, omega: [f64; 4]) -> f64 {
    let along = times(field, &omega);
    let exponent: f64 = omega.iter().zip(along).map(|(a, b)| a * b).sum();
    libm::exp(-0.5 * POWER * exponent)
}
