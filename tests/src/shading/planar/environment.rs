//! Spectra of the differential irradiance that an environment causes on a curved surface.
//!
//! In the functions of this module, k ≠ 0 is the curvature in 1/m, which is positive for convex
//! surfaces, and `environment` is env^. Angles are angles on the surface, for directions towards
//! the light.

use etendue_field::{Complex, cis};
use etendue_theory::shading::cosine_hat;
use std::f64::consts::{PI, TAU};

/// The spectrum of the differential irradiance dE' in the frames of the local normals:
/// 1/|k| env^(Ωx/k) cos⁺^(Ωθ − Ωx/k).
pub(crate) fn differential_irradiance(
    k: f64,
    omega: [f64; 2],
    environment: &dyn Fn(f64) -> Complex,
) -> Complex {
    let [x, theta] = omega;
    environment(x / k) * (cosine_hat(theta - x / k) / k.abs())
}

/// The spectrum of the differential irradiance dE'_r after the mirror step: 1/|k|
/// env^(Ωx/k) cos⁺^(Ωθ + Ωx/k).
///
/// Section 6.1 of Durand et al. 2005 prints ℓ_i(0, Ωx/k) cos⁺^(Ωx/k − Ωθ). The printed formula
/// lacks the hat of ℓ_i and the factor 1/|k|. Its sign is correct only before the mirror step.
pub(crate) fn mirrored_differential_irradiance(
    k: f64,
    omega: [f64; 2],
    environment: &dyn Fn(f64) -> Complex,
) -> Complex {
    let [x, theta] = omega;
    differential_irradiance(k, [x, -theta], environment)
}

/// A Gaussian light in an environment, A exp(−(θ − μ)²/2σ²).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Glow {
    /// Amplitude A, radiance.
    pub(crate) amplitude: f64,
    /// Mean μ, radians.
    pub(crate) mean: f64,
    /// Standard deviation σ, radians.
    pub(crate) deviation: f64,
}

impl Glow {
    /// Returns env(θ).
    pub(crate) fn value(&self, theta: f64) -> f64 {
        let z = (theta - self.mean) / self.deviation;
        self.amplitude * libm::exp(-0.5 * z * z)
    }

    /// Returns env^(Ω) = A σ √(2π) exp(−2π²σ²Ω²) e^(−2πi Ωμ).
    pub(crate) fn spectrum(&self, omega: f64) -> Complex {
        let z = PI * self.deviation * omega;
        let size = self.amplitude * self.deviation * TAU.sqrt() * libm::exp(-2.0 * z * z);
        cis(-TAU * omega * self.mean) * size
    }
}
