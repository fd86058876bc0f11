//! Numbers: Gauss–Legendre rules, sin(πx)/(πx), and how far slices are apart.

pub(crate) mod quadrature;
pub(crate) mod sinc;

use etendue_field::Slices;

/// ‖a − b‖/‖b‖; 0 if both are dark.
pub(crate) fn distance(a: &Slices, b: &Slices) -> f64 {
    let (mut error, mut size) = (0.0, 0.0);
    for (a, b) in a.half.iter().zip(&b.half) {
        error += (a - b).norm_sqr();
        size += b.norm_sqr();
    }
    if error == 0.0 {
        0.0
    } else {
        (error / size).sqrt()
    }
}
