//! Covariances of Gaussian light fields, for chains that follow only second moments.
//!
//! A field exp(−½ zᵀ S⁻¹ z) has the covariance S, and remains Gaussian under every step. Three
//! functions compute the new S. [`covariance`](crate::geometry::AffineMap::covariance) computes it after an
//! [`AffineMap`](crate::geometry::AffineMap), [`gaussian_window`] after a product, and [`gaussian_lobe`]
//! after a convolution over angles.

use crate::geometry::matrix::{self, Matrix, congruent, diagonal, dot, product, sum, times};
use std::array;
use std::f64::consts::{PI, TAU};

/// The covariance after a product with a Gaussian window of standard deviations `std`, one
/// for each coordinate. The product changes S⁻¹ to S⁻¹ + diag(1/std²). Infinite standard deviations
/// have no effect.
///
/// The result is computed as S (1 + diag(1/std²) S)⁻¹, which allows a singular S. For example,
/// light from a point has a singular S. Returns `None` if 1 + diag(1/std²) S has no inverse, which
/// cannot occur if S is a covariance.
pub(crate) fn gaussian_window<const N: usize>(
    before: &Matrix<N>,
    std: [f64; N],
) -> Option<Matrix<N>> {
    let narrowing = product(&diagonal(std.map(|s| 1.0 / (s * s))), before);
    let kept = matrix::inverse(&sum(&diagonal([1.0; N]), &narrowing))?;
    Some(product(before, &kept))
}

/// The covariance after a convolution over angles with a Gaussian of standard deviation
/// `std`, in radians: S_θθ and, in 4D, S_φφ increase by std². The Gaussian represents a glossy
/// lobe of unit integral (Durand et al. 2005, Eq. 16).
pub(crate) fn gaussian_lobe<const N: usize>(before: &Matrix<N>, std: f64) -> Matrix<N> {
    let blur = array::from_fn(|i| if i < N / 2 { 0.0 } else { std * std });
    sum(before, &diagonal(blur))
}

/// S⁻¹/8π², the covariance of |L|² for a Gaussian field of covariance S. The covariance of
/// |L| is twice as large.
///
/// The result is in cycles per unit, squared. Returns `None` for a singular S, whose spectrum is
/// unbounded.
pub(crate) fn power_spectrum<const N: usize>(field: &Matrix<N>) -> Option<Matrix<N>> {
    let inverse = matrix::inverse(field)?;
    Some(inverse.map(|row| row.map(|entry| entry / (8.0 * PI * PI))))
}

/// The spectrum of exp(−½ zᵀ S⁻¹ z): (2π)^(N/2) √det S exp(−2π² Ωᵀ S Ω).
pub(crate) fn gaussian_spectrum<const N: usize>(field: &Matrix<N>, omega: [f64; N]) -> f64 {
    let volume = congruent(&diagonal([TAU.sqrt(); N]), field);
    let exponent = -2.0 * PI * PI * dot(&omega, &times(field, &omega));
    matrix::determinant(&volume).sqrt() * libm::exp(exponent)
}
