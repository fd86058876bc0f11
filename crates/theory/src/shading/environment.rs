//! Spectra of environment light on a curved surface. Environment light depends only on direction.
//!
//! The light ℓ(s, θ) = env(θ) has the spectrum env^(Ωθ) δ(Ωx). After the curvature step the
//! spectrum is on the line Ωx = kΩθ. On this line each Ωx has a single value, so the convolution
//! with the cosine becomes a product (Durand et al. 2005, section 6.1 and Fig. 14). In the
//! functions of this module, k ≠ 0 is the curvature in 1/m, which is positive for convex surfaces,
//! and `environment` is env^. Angles are angles on the surface, for directions towards the light.

use super::cosine_hat;
use etendue_field::{Complex, cis};
use std::f64::consts::{PI, TAU};

/// Returns the spectrum of the differential irradiance dE' in the frames of the local normals:
/// 1/|k| env^(Ωx/k) cos⁺^(Ωθ − Ωx/k).
#[must_use]
pub fn differential_irradiance(
    k: f64,
    omega: [f64; 2],
    environment: &dyn Fn(f64) -> Complex,
) -> Complex {
    let [x, theta] = omega;
    environment(x / k) * (cosine_hat(theta - x / k) / k.abs())
}

/// Returns the spectrum of the differential irradiance dE'_r after the mirror step: 1/|k|
/// env^(Ωx/k) cos⁺^(Ωθ + Ωx/k).
///
/// Section 6.1 of Durand et al. 2005 prints ℓ_i(0, Ωx/k) cos⁺^(Ωx/k − Ωθ). The printed formula
/// lacks the hat of ℓ_i and the factor 1/|k|. Its sign is correct only before the mirror step.
#[must_use]
pub fn mirrored_differential_irradiance(
    k: f64,
    omega: [f64; 2],
    environment: &dyn Fn(f64) -> Complex,
) -> Complex {
    let [x, theta] = omega;
    differential_irradiance(k, [x, -theta], environment)
}

/// Returns the spectrum 1/|k| env^(Ωx/k) cos⁺^(Ωx/k) of the irradiance along the surface, E(s) = ∫
/// env(θ) cos⁺(θ − k s) dθ.
///
/// This spectrum is a product of spectra, so the irradiance is a convolution in the primal domain
/// (Ramamoorthi and Hanrahan 2001). Section 6.1 of Durand et al. 2005 omits 1/|k|.
#[must_use]
pub fn irradiance(k: f64, omega_x: f64, environment: &dyn Fn(f64) -> Complex) -> Complex {
    differential_irradiance(k, [omega_x, 0.0], environment)
}

/// A Gaussian light in an environment, A exp(−(θ − μ)²/2σ²).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glow {
    /// Amplitude A, radiance.
    pub amplitude: f64,
    /// Mean μ, radians.
    pub mean: f64,
    /// Standard deviation σ, radians.
    pub deviation: f64,
}

impl Glow {
    /// Returns env(θ).
    #[must_use]
    pub fn value(&self, theta: f64) -> f64 {
        let z = (theta - self.mean) / self.deviation;
        self.amplitude * libm::exp(-0.5 * z * z)
    }

    /// Returns env^(Ω) = A σ √(2π) exp(−2π²σ²Ω²) e^(−2πi Ωμ).
    #[must_use]
    pub fn spectrum(&self, omega: f64) -> Complex {
        let z = PI * self.deviation * omega;
        let size = self.amplitude * self.deviation * TAU.sqrt() * libm::exp(-2.0 * z * z);
        cis(-TAU * omega * self.mean) * size
    }
}
