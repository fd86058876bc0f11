//! Transforms of factors that are tables of values over an angle.

use etendue_field::AngleTable;
use etendue_theory::shading::even_transform;
use std::f64::consts::FRAC_PI_2;

/// The transform of t(|θ|) g(θ) on |θ| < π/2, for a table t and an even function g, with Ω
/// in cycles per radian. The product is the factor f(θi) or h(θo) of a separable BRDF (Durand et
/// al. 2005, section 4.3). If the factor includes the cosine, g is the cosine. The transform is
/// real and even.
///
/// The transform is computed by Gauss rules between the values of the table, to 10⁻¹² for a smooth
/// g.
pub(crate) fn table_hat(table: &AngleTable, g: impl Fn(f64) -> f64, omega: f64) -> f64 {
    let steps = (table.values.len() - 1) as f64;
    let nodes = table.values.iter().zip(0_u32..);
    let ends: Vec<f64> = nodes
        .map(|(_, i)| FRAC_PI_2 * f64::from(i) / steps)
        .collect();
    even_transform(&ends, omega, |theta| {
        table.value(libm::cos(theta)) * g(theta)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_theory::shading::cosine_hat;
    use std::f64::consts::{PI, TAU};

    #[test]
    fn a_triangle_and_a_constant() {
        let of = |values: &[f64]| AngleTable {
            values: values.into(),
        };
        for omega in [0.0, 0.3, 2.0, 11.0] {
            let constant = table_hat(&of(&[1.0, 1.0, 1.0]), libm::cos, omega);
            assert!((constant - cosine_hat(omega)).abs() < 1e-12); // the stated error
            // The factor 1 − |θ|/(π/2) has the transform π/2 sinc²(Ω π/2).
            let half = 0.5 * PI * omega * 0.5 * TAU;
            let sinc = if omega > 0.0 {
                libm::sin(half) / half
            } else {
                1.0
            };
            let triangle = table_hat(&of(&[1.0, 0.5, 0.0]), |_| 1.0, omega);
            assert!(
                (triangle - FRAC_PI_2 * sinc * sinc).abs() < 1e-12,
                "{omega}"
            ); // the stated error
        }
    }
}
