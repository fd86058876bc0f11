//! Tests of covariance tracing against Gaussian light fields and against quadrature.

mod chains;
mod factors;
mod operators;

use crate::geometry::{AffineMap, Matrix};

/// The largest difference between entries of two matrices, relative to the geometric mean
/// of the corresponding diagonal entries.
fn apart(a: &Matrix<4>, b: &Matrix<4>) -> f64 {
    let entries = (0..4).flat_map(|i| (0..4).map(move |j| (i, j)));
    let off = entries.map(|(i, j)| (a[i][j] - b[i][j]).abs() / (b[i][i] * b[j][j]).sqrt());
    off.fold(0.0, f64::max)
}

/// The map of a rotation of the axes, a mirror reflection by a curved surface, and travel.
/// Because of the rotation, no entry of the map's matrix is zero.
fn bent() -> AffineMap<4> {
    let shape = [[0.7, 0.2], [0.2, -0.4]];
    AffineMap::<4>::rotation(0.4)
        .then(&AffineMap::<4>::mirror_reflection(0.6, shape))
        .then(&AffineMap::travel(0.8))
}
