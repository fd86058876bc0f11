//! The cosine factors of diffuse shading, in slopes, and their transforms.

use complex_bessel::besselk;
use etendue_field::Complex;
use std::f64::consts::{PI, TAU};

/// Transform of g(v) = (1 + v²)^(−3/2), the cosine times dθ/dv in 2D: ĝ(Ω) = 4π|Ω| K₁(2π|Ω|), 2 at
/// zero (Durand et al. 2005, section 3.3). Ω in cycles per unit slope.
#[must_use]
pub fn g_hat(omega: f64) -> f64 {
    2.0 * z_k1(TAU * omega.abs())
}

/// Transform of G(u, v) = (1 + u² + v²)⁻², the cosine times dω/(du dv) in 3D (Durand et al. 2005,
/// section 5.1): Ĝ(Ωu, Ωv) = 2π² r K₁(2πr), r = |(Ωu, Ωv)|, π at zero; equal to π/2 · ĝ(r).
#[must_use]
pub fn g_hat_3d(omega_u: f64, omega_v: f64) -> f64 {
    PI * z_k1(TAU * omega_u.hypot(omega_v))
}

/// z K₁(z), 1 at zero.
fn z_k1(z: f64) -> f64 {
    // 1 + z²/2 ln(z/2) is 1 to rounding.
    if z < 1e-9 {
        return 1.0;
    }
    // exp(−z) has underflown.
    if z > 745.0 {
        return 0.0;
    }
    besselk(1.0, Complex::from(z)).map_or(f64::NAN, |k| z * k.re)
}
