//! Transforms of the cosine factors of diffuse shading, which are functions of slopes.

use std::f64::consts::{PI, TAU};

/// The transform of g(v) = (1 + v²)^(−3/2), the cosine times dθ/dv in 2D (Durand et al.
/// 2005, section 3.3): ĝ(Ω) = 4π|Ω| K₁(2π|Ω|), which is 2 at zero. Ω is in cycles per unit slope.
#[must_use]
pub fn g_hat(omega: f64) -> f64 {
    2.0 * z_k1(TAU * omega.abs())
}

/// The transform of G(u, v) = (1 + u² + v²)⁻², the cosine times dω/(du dv) in 3D (Durand et
/// al. 2005, section 5.1): Ĝ(Ωu, Ωv) = 2π² r K₁(2πr), with r = |(Ωu, Ωv)|. The transform is π at
/// zero, and equals π/2 · ĝ(r).
#[must_use]
pub fn g_hat_3d(omega_u: f64, omega_v: f64) -> f64 {
    PI * z_k1(TAU * libm::hypot(omega_u, omega_v))
}

/// Returns z K₁(z) = ∫ z cosh t exp(−z cosh t) dt over t ≥ 0, which is 1 at zero.
///
/// The integrand is even and analytic, so the error of sums with equal steps h falls as exp(−π²/h),
/// and as exp(−2π²/(z h²)) for large z.
fn z_k1(z: f64) -> f64 {
    // For small z the value is 1 + z²/2 ln(z/2), which is 1 up to rounding error.
    if z < 1e-9 {
        return 1.0;
    }
    // exp(−z) has underflowed.
    if z > 745.0 {
        return 0.0;
    }
    let step = f64::min(0.2, 0.6 / z.sqrt());
    let integrand = |i: usize| {
        let stretched = z * libm::cosh(step * i as f64);
        stretched * libm::exp(-stretched)
    };
    let first = integrand(0);
    let others = (1..).map(integrand).take_while(|f| *f > 1e-18 * first);
    step * (0.5 * first + others.sum::<f64>())
}

#[cfg(test)]
mod tests {
    use super::z_k1;

    #[test]
    fn the_bessel_function_is_that_of_a_library() {
        for z in [
            2e-9, 1e-4, 0.03, 0.4, 1.0, 2.7, 7.8, 9.0, 31.0, 300.0, 600.0,
        ] {
            let k1 = complex_bessel::besselk(1.0, z.into()).expect("in range").re;
            // The limit is the rounding error of z cosh t, which is an absolute error in the
            // exponent.
            let rounding = 4e-16 * (2.0 + z);
            assert!(
                (z_k1(z) / (z * k1) - 1.0).abs() < rounding,
                "{z}: {:e}",
                z_k1(z) / (z * k1) - 1.0
            );
        }
    }
}
