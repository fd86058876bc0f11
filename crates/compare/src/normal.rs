//! The least-squares step of several parameters from the residuals of several planes.

use crate::residuals::Residuals;
use etendue_field::Complex;
use ndarray::{Array1, Array2, Array3, Axis};

/// The normal equations A δ = g of n parameters, with weights 1/σ² at each frequency.
///
/// If D_i are the derivatives of the slices, A_ij = Re Σ conj(D_i) D_j/σ² and g_bi = Re Σ conj(D_i)
/// r_b/σ² for residual b. The planes of a scene add up, because residual b of each plane is from the
/// same photons.
#[derive(Clone, Debug)]
pub struct NormalEquations {
    /// A, [n, n].
    pub information: Array2<f64>,
    /// g of each residual, [R, n].
    pub scores: Array2<f64>,
}

impl NormalEquations {
    /// The equations of a plane; `variance` is the variance of the mean residual.
    #[must_use]
    pub fn new(
        residuals: &Residuals,
        variance: &Array3<f64>,
        derivatives: &[Array3<Complex>],
    ) -> Self {
        let product = |a: &Complex, b: &Complex| a.re * b.re + a.im * b.im;
        let count = derivatives.len();
        let mut information = Array2::zeros((count, count));
        let mut scores = Array2::zeros((residuals.count(), count));
        for (i, derivative) in derivatives.iter().enumerate() {
            let weighted = weighted(derivative, variance);
            for (j, other) in derivatives.iter().enumerate().take(i + 1) {
                information[[i, j]] = residuals.sum(&weighted, other, product);
                information[[j, i]] = information[[i, j]];
            }
            for (b, residual) in residuals.each().enumerate() {
                scores[[b, i]] = residuals.sum(&weighted, residual, product);
            }
        }
        Self {
            information,
            scores,
        }
    }

    /// The equations of two planes with the same number of residuals.
    #[must_use]
    pub fn plus(self, other: &Self) -> Self {
        Self {
            information: self.information + &other.information,
            scores: self.scores + &other.scores,
        }
    }

    /// The equations of some parameters if the others are known.
    #[must_use]
    pub fn only(&self, of: &[usize]) -> Self {
        Self {
            information: self.information.select(Axis(0), of).select(Axis(1), of),
            scores: self.scores.select(Axis(1), of),
        }
    }

    /// The step of each residual, [R, n]; their mean is the least-squares step. `None` if A is
    /// singular.
    #[must_use]
    pub fn steps(&self) -> Option<Array2<f64>> {
        let steps = solved(&self.information, &self.scores.t().to_owned())?;
        Some(steps.t().to_owned())
    }
}

/// A derivative divided by the variance; zero where there is no noise.
pub(crate) fn weighted(derivative: &Array3<Complex>, variance: &Array3<f64>) -> Array3<Complex> {
    let mut weighted = derivative.clone();
    weighted.zip_mut_with(variance, |d, v| {
        *d = if *v > 0.0 { *d / v } else { (*d).scale(0.0) }
    });
    weighted
}

/// The smallest pivot of an information matrix, as a share of the diagonal, that is not a rounding
/// error.
const MIN_PIVOT: f64 = 1e-13;

/// The solution X of A X = B for a symmetric positive matrix, by elimination. `None` if A is
/// singular.
#[must_use]
pub fn solved(matrix: &Array2<f64>, right: &Array2<f64>) -> Option<Array2<f64>> {
    let (mut a, mut x) = (matrix.clone(), right.clone());
    let n = a.nrows();
    for k in 0..n {
        let pivot = a[[k, k]];
        if pivot.is_nan() || pivot <= MIN_PIVOT * matrix[[k, k]] {
            return None;
        }
        for i in k + 1..n {
            let factor = a[[i, k]] / pivot;
            for j in k..n {
                a[[i, j]] -= factor * a[[k, j]];
            }
            for j in 0..x.ncols() {
                x[[i, j]] -= factor * x[[k, j]];
            }
        }
    }
    for k in (0..n).rev() {
        for j in 0..x.ncols() {
            let known: f64 = (k + 1..n).map(|i| a[[k, i]] * x[[i, j]]).sum();
            x[[k, j]] = (x[[k, j]] - known) / a[[k, k]];
        }
    }
    Some(x)
}

/// The smallest eigenvalue of a symmetric matrix without negative eigenvalues and with ones on its
/// diagonal, and its eigenvector, by inverse iteration.
#[must_use]
pub fn least_eigenvector(matrix: &Array2<f64>) -> (f64, Array1<f64>) {
    const ROUNDS: usize = 100;
    /// Added to the diagonal, so that a singular matrix has an inverse.
    const SHIFT: f64 = 1e-12;
    let n = matrix.nrows();
    let shifted = matrix + Array2::<f64>::eye(n) * SHIFT;
    // No symmetry of the matrix has this vector.
    let mut vector = Array1::from_shape_fn(n, |i| 1.0 / (i as f64 + 1.0).sqrt());
    for _ in 0..ROUNDS {
        let column = vector.clone().insert_axis(Axis(1));
        let Some(next) = solved(&shifted, &column) else {
            break;
        };
        vector = next.index_axis_move(Axis(1), 0);
        vector /= vector.dot(&vector).sqrt();
    }
    (vector.dot(&matrix.dot(&vector)), vector)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn a_matrix_is_solved_and_has_its_least_eigenvector() {
        let a = array![[1.0, 0.7, -0.5], [0.7, 1.0, 0.25], [-0.5, 0.25, 1.0]];
        let b = array![[1.0], [-2.0], [0.5]];
        let x = solved(&a, &b).unwrap();
        let rounding = 1e-12;
        assert!((a.dot(&x) - b).iter().all(|off| off.abs() < rounding));
        let (value, vector) = least_eigenvector(&a);
        let off = a.dot(&vector) - &vector * value;
        assert!(off.iter().all(|off| off.abs() < rounding));
        // The three eigenvalues add up to 3, and their product is the determinant.
        assert!(value > 0.0 && value < 0.1, "{value}");
        let singular = array![[1.0, 1.0], [1.0, 1.0]];
        assert!(solved(&singular, &array![[1.0], [1.0]]).is_none());
        let (value, vector) = least_eigenvector(&singular);
        assert!(value.abs() < rounding && (vector[0] + vector[1]).abs() < rounding);
    }
}
