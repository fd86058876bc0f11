//! Schlick's approximation of the reflectance of an interface.

use etendue_theory::shading::{cosine_hat, cosine_power_hat};

/// Schlick's approximation (Schlick 1994, Eq. 24), F₀ + (1 − F₀)(1 − cos θ)⁵, for the reflectance F₀
/// at normal incidence.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Schlick(pub(crate) f64);

impl Schlick {
    pub(crate) fn reflectance(self, theta: f64) -> f64 {
        self.0 + (1.0 - self.0) * (1.0 - libm::cos(theta)).powi(5)
    }

    /// The transform of F(θ) cos⁺(θ): F₀ C₁ + (1 − F₀) Σ (−1)ⁱ (5 over i) Cᵢ₊₁, with the
    /// transforms Cₙ of cosⁿ.
    pub(crate) fn cosine_hat(self, omega: f64) -> f64 {
        let binomial = [1.0, -5.0, 10.0, -10.0, 5.0, -1.0].into_iter();
        let powers = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0].map(|n| cosine_power_hat(n, omega));
        let rest: f64 = binomial.zip(powers).map(|(b, c)| b * c).sum();
        self.0 * cosine_hat(omega) + (1.0 - self.0) * rest
    }
}
