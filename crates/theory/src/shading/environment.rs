//! The spectrum of environment light on a curved surface. Environment light depends only on
//! direction.
//!
//! The light ℓ(s, θ) = env(θ) has the spectrum env^(Ωθ) δ(Ωx). After the curvature step the
//! spectrum is on the line Ωx = kΩθ. On this line each Ωx has a single value, so the convolution
//! with the cosine becomes a product (Durand et al. 2005, section 6.1 and Fig. 14).

use super::cosine_hat;
use etendue_field::Complex;

/// The spectrum 1/|k| env^(Ωx/k) cos⁺^(Ωx/k) of the irradiance along the surface, E(s) = ∫
/// env(θ) cos⁺(θ − k s) dθ.
///
/// This spectrum is a product of spectra, so the irradiance is a convolution in the primal domain
/// (Ramamoorthi and Hanrahan 2001). Section 6.1 of Durand et al. 2005 omits 1/|k|. k ≠ 0 is the
/// curvature in 1/m, which is positive for convex surfaces, and `environment` is env^.
#[must_use]
pub fn irradiance(k: f64, omega_x: f64, environment: &dyn Fn(f64) -> Complex) -> Complex {
    environment(omega_x / k) * (cosine_hat(-omega_x / k) / k.abs())
}
