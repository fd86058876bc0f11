//! Small square matrices.

use std::array;
use std::cmp::Ordering;

/// A square matrix, stored as rows.
pub type Matrix<const N: usize> = [[f64; N]; N];

pub(crate) fn from_fn<const N: usize>(entry: impl Fn(usize, usize) -> f64) -> Matrix<N> {
    array::from_fn(|i| array::from_fn(|j| entry(i, j)))
}

pub(crate) fn diagonal<const N: usize>(entries: [f64; N]) -> Matrix<N> {
    from_fn(|i, j| if i == j { entries[i] } else { 0.0 })
}

pub(crate) fn transpose<const N: usize>(a: &Matrix<N>) -> Matrix<N> {
    from_fn(|i, j| a[j][i])
}

pub(crate) fn product<const N: usize>(a: &Matrix<N>, b: &Matrix<N>) -> Matrix<N> {
    from_fn(|i, j| (0..N).map(|k| a[i][k] * b[k][j]).sum())
}

pub(crate) fn sum<const N: usize>(a: &Matrix<N>, b: &Matrix<N>) -> Matrix<N> {
    from_fn(|i, j| a[i][j] + b[i][j])
}

pub(crate) fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    (0..N).map(|i| a[i] * b[i]).sum()
}

/// The product A z of a matrix and a vector.
pub(crate) fn times<const N: usize>(a: &Matrix<N>, z: &[f64; N]) -> [f64; N] {
    a.map(|row| dot(&row, z))
}

pub(crate) fn plus<const N: usize>(a: &[f64; N], b: &[f64; N]) -> [f64; N] {
    array::from_fn(|i| a[i] + b[i])
}

/// The matrix A S Aᵀ.
pub(crate) fn congruent<const N: usize>(a: &Matrix<N>, s: &Matrix<N>) -> Matrix<N> {
    product(&product(a, s), &transpose(a))
}

/// The matrix that applies the matrix `x` to the coordinates (0, 2) and the matrix `y` to
/// the coordinates (1, 3).
pub(crate) fn sections(x: &Matrix<2>, y: &Matrix<2>) -> Matrix<4> {
    let parts = [x, y];
    from_fn(|i, j| {
        if i % 2 == j % 2 {
            parts[i % 2][i / 2][j / 2]
        } else {
            0.0
        }
    })
}

/// The determinant.
pub(crate) fn determinant<const N: usize>(a: &Matrix<N>) -> f64 {
    eliminate(*a).map_or_else(|zero| zero, |(determinant, _)| determinant)
}

/// The inverse of a matrix, or `None` if a pivot of the elimination is zero or not finite.
pub(crate) fn inverse<const N: usize>(a: &Matrix<N>) -> Option<Matrix<N>> {
    eliminate(*a).ok().map(|(_, inverse)| inverse)
}

/// Returns the determinant and the inverse of a matrix by elimination with row pivoting; if there
/// is no inverse, returns the determinant as an error.
fn eliminate<const N: usize>(mut a: Matrix<N>) -> Result<(f64, Matrix<N>), f64> {
    let mut inverse = diagonal([1.0; N]);
    let mut determinant = 1.0;
    for k in 0..N {
        let size = |i: usize| a[i][k].abs();
        let largest = (k..N).fold(k, |most, i| match size(i).total_cmp(&size(most)) {
            Ordering::Greater => i,
            _ => most,
        });
        if largest != k {
            a.swap(k, largest);
            inverse.swap(k, largest);
            determinant = -determinant;
        }
        let pivot = a[k][k];
        determinant *= pivot;
        if !pivot.is_normal() {
            return Err(determinant);
        }
        a[k] = a[k].map(|entry| entry / pivot);
        inverse[k] = inverse[k].map(|entry| entry / pivot);
        for i in (0..N).filter(|&i| i != k) {
            let factor = a[i][k];
            a[i] = array::from_fn(|j| a[i][j] - factor * a[k][j]);
            inverse[i] = array::from_fn(|j| inverse[i][j] - factor * inverse[k][j]);
        }
    }
    Ok((determinant, inverse))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_and_determinant() {
        let a = [
            [0.0, 2.0, 0.0, 1.0],
            [1.0, 0.0, 3.0, 0.0],
            [0.0, 1.0, 0.0, -1.0],
            [2.0, 0.0, -1.0, 0.5],
        ];
        // The determinant 21 is the product of the determinants of the blocks (0, 2) and (1, 3),
        // computed by hand.
        assert!((determinant(&a) - 21.0).abs() < 1e-13); // rounding of 21
        let unit = product(&a, &inverse(&a).unwrap());
        let one = diagonal([1.0; 4]);
        let off = (0..16).map(|n| (unit[n / 4][n % 4] - one[n / 4][n % 4]).abs());
        assert!(off.fold(0.0, f64::max) < 1e-15); // rounding
    }

    #[test]
    fn singular_has_no_inverse() {
        assert!(inverse(&[[1.0, 2.0], [2.0, 4.0]]).is_none());
        assert!(inverse(&[[f64::NAN, 2.0], [2.0, 4.0]]).is_none());
        assert!(determinant(&[[1.0, 2.0], [2.0, 4.0]]).abs() < f64::MIN_POSITIVE);
        assert!(determinant(&[[f64::NAN, 2.0], [2.0, 4.0]]).is_nan());
    }
}
