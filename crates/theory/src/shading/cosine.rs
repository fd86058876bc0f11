//! Transforms of cosines on the half-circle.

use etendue_field::sinc;
use libm::lgamma as ln_gamma;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The transform of the clamped cosine, which is cos θ for |θ| < π/2 and 0 elsewhere. The
/// transform is 2 cos(π²Ω)/(1 − (2πΩ)²), with Ω in cycles per radian (Durand et al. 2005, Eq. 13).
///
/// The transform is computed as π/2 [sinc((1 − w)/2) + sinc((1 + w)/2)] with w = 2πΩ. This form is
/// accurate also at Ω = 1/2π, where the quotient is 0/0 and the transform is π/2. The transform is
/// 2 at zero and falls as 1/Ω², because the cosine has a corner at π/2. 99 % of the transform's
/// energy lies below 0.376. The coefficient of e^(inθ) in the Fourier series on the full circle
/// is the transform at n/2π, divided by 2π.
#[must_use]
pub fn cosine_hat(omega: f64) -> f64 {
    let w = TAU * omega;
    FRAC_PI_2 * (sinc(0.5 * (1.0 - w)) + sinc(0.5 * (1.0 + w)))
}

/// The transform of cos² φ on |φ| < π/2, which is the factor of the cosine along latitudes
/// in 4D: dE = ℓ cos θ cos² φ dθ dφ.
///
/// The transform is π/2 sinc(w/2) + π/4 [sinc((w − 2)/2) + sinc((w + 2)/2)], w = 2πΩ. Durand et al.
/// 2005, section 5.2, give no formula for this transform.
#[must_use]
pub fn cosine_squared_hat(omega: f64) -> f64 {
    let w = TAU * omega;
    let sides = sinc(0.5 * (w - 2.0)) + sinc(0.5 * (w + 2.0));
    0.5 * PI * sinc(0.5 * w) + 0.25 * PI * sides
}

/// The transform of cosⁿ θ on |θ| < π/2, n ≥ 0: π Γ(n + 1)/(2ⁿ Γ(1 + n/2 + πΩ) Γ(1 + n/2 −
/// πΩ)) (Gradshteyn and Ryzhik, 3.631.9).
///
/// The transform is zero at the poles of the second gamma function, where 1 + n/2 − πΩ is 0, −1, …
/// The relative error is about 10⁻¹⁵ (n + Ω) ln(n + Ω) away from zeros.
#[must_use]
pub fn cosine_power_hat(exponent: f64, omega: f64) -> f64 {
    let (middle, side) = (1.0 + 0.5 * exponent, PI * omega.abs());
    // ln |Γ| is infinite at the poles of Γ.
    let (below, sign) = libm::lgamma_r(middle - side);
    let ln =
        ln_gamma(exponent + 1.0) - exponent * libm::log(2.0_f64) - ln_gamma(middle + side) - below;
    PI * f64::from(sign) * libm::exp(ln)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shading::panels::even_transform;

    const FREQUENCIES: [f64; 8] = [0.0, 0.1, 0.5 / PI, 1.0 / PI, 1.5 / PI, 0.7, 3.3, 20.0];

    #[test]
    fn transforms_of_powers() {
        for omega in FREQUENCIES {
            for n in [0.0, 1.0, 2.0, 2.5, 7.0, 60.0] {
                let ends = [0.0, 0.2, 0.5, 1.0, 1.4, 1.5, FRAC_PI_2];
                let plain = even_transform(&ends, omega, |t| libm::pow(libm::cos(t), n));
                let got = cosine_power_hat(n, omega);
                // The limit is the rounding error of ln Γ. For cos^2.5 the limit is 1e-8, because
                // Gauss rules converge slowly at its ends.
                let close = if n % 1.0 > 0.0 { 1e-8 } else { 1e-13 };
                assert!((got - plain).abs() < close, "{n} {omega}: {got} {plain}");
            }
            let [one, two] = [1.0, 2.0].map(|n| cosine_power_hat(n, omega));
            // The limit is three times the rounding error of ln Γ for arguments up to 25.
            assert!((cosine_hat(omega) - one).abs() < 1e-13);
            assert!((cosine_squared_hat(omega) - two).abs() < 1e-13); // rounding
        }
    }

    /// Tests that the transform of cos² is zero where z = 2 − πΩ is a pole of Γ, and that it agrees
    /// with the transform of cos⁴ on both sides of the pole by Γ(z + 1) = z Γ(z).
    #[test]
    fn poles_of_gamma_are_zeros_of_the_transform() {
        for pole in 0..12 {
            let z = -f64::from(pole);
            let at =
                |exponent: f64, z: f64| cosine_power_hat(exponent, (1.0 + 0.5 * exponent - z) / PI);
            assert!(at(2.0, z).abs() < 1e-15, "{z}");
            for z in [z + 0.1, z - 0.1] {
                // From n to n + 2, z increases by 1 at a fixed Ω.
                let (middle, side) = (2.0, 2.0 - z);
                let step = 12.0 / (4.0 * (middle + side) * (middle - side));
                let ratio = at(4.0, z + 1.0) / at(2.0, z);
                // The limit is the rounding error of ln Γ for arguments up to 20.
                assert!((ratio / step - 1.0).abs() < 1e-13, "{z}");
            }
        }
    }
}
