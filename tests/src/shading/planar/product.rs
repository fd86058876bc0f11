//! Products in the primal domain. They are computed as convolutions of spectra, which are sums over
//! a lattice of frequencies.

use etendue_field::Complex;
use std::f64::consts::TAU;

/// The frequencies n·`spacing`, up to `reach` on both sides of zero, over which spectra are summed.
///
/// The error of the sum has two parts. The first part is the product of the factor and copies of
/// the light that are displaced by multiples of 1/`spacing` along the axis (Poisson's formula).
/// This part is zero if the light and the factor have bounded support and the spacing is small
/// enough. The second part is due to the spectrum of the light beyond `reach`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lattice {
    /// Distance between two frequencies, in cycles per unit of the axis.
    pub(crate) spacing: f64,
    /// The largest frequency at which the spectrum of the *light* is not negligible, in cycles per
    /// unit of the axis.
    pub(crate) reach: f64,
}

impl Lattice {
    /// The frequencies of a Fourier series on the full circle, which are 1/2π apart. Sums
    /// over these frequencies are exact for factors on the half-circle and light within ± 3π/2.
    pub(crate) fn circle(reach: f64) -> Self {
        let spacing = 1.0 / TAU;
        Self { spacing, reach }
    }

    fn sum(&self, term: impl Fn(f64) -> Complex) -> Complex {
        let most = (self.reach / self.spacing).ceil();
        let mut sum = Complex::from(0.0);
        let mut n = -most;
        while n <= most {
            sum += term(n * self.spacing);
            n += 1.0;
        }
        sum * self.spacing
    }
}

/// The spectrum at Ω of f(θ) ℓ(x, θ), which is ∫ L(Ωx, q) f̂(Ωθ − q) dq (Durand et al.
/// 2005, Eq. 12, where ⊗ is a convolution in 2D with a Dirac along Ωx).
///
/// `factor` is f̂, in cycles per radian; `before` is L.
pub(crate) fn angular_product(
    lattice: &Lattice,
    omega: [f64; 2],
    factor: &dyn Fn(f64) -> Complex,
    before: &dyn Fn([f64; 2]) -> Complex,
) -> Complex {
    let [x, theta] = omega;
    lattice.sum(|q| before([x, q]) * factor(theta - q))
}

/// A wave A e^(2πi f s) of a texture along the surface. A real texture also contains the conjugate
/// of each wave, at −f.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TextureWave {
    /// Frequency f, in cycles per metre of arc length.
    pub(crate) frequency: f64,
    /// Amplitude A.
    pub(crate) amplitude: Complex,
}

/// The spectrum at Ω of T(s) ℓ(s, θ), where the texture T is a sum of waves: Σ A L(Ωx − f,
/// Ωθ) (Durand et al. 2005, Eq. 18).
///
/// A texture depends only on positions, so it may be applied before or after the step back from the
/// local normals, but must be applied before the step of the outgoing angle.
pub(crate) fn texture(
    waves: &[TextureWave],
    omega: [f64; 2],
    before: &dyn Fn([f64; 2]) -> Complex,
) -> Complex {
    let [x, theta] = omega;
    let waves = waves.iter();
    waves
        .map(|wave| wave.amplitude * before([x - wave.frequency, theta]))
        .sum()
}

/// The spectrum at Ω after reflection by a BRDF ρ(s, δ) that varies in space. The spectrum
/// is ∫ L(q, Ωθ) ρ̂(Ωx − q, Ωθ) dq, which is a convolution only along Ωx (the "semi-convolution" of
/// Durand et al. 2005, section 4.5).
///
/// `brdf` is the transform of ρ in both variables; `lattice` is along Ωx, in cycles per metre. If
/// `brdf` does not depend on Ωθ, it represents a texture.
pub(crate) fn semi_convolution(
    lattice: &Lattice,
    omega: [f64; 2],
    brdf: &dyn Fn([f64; 2]) -> Complex,
    before: &dyn Fn([f64; 2]) -> Complex,
) -> Complex {
    let [x, theta] = omega;
    lattice.sum(|q| before([q, theta]) * brdf([x - q, theta]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn bell(width: f64, omega: f64) -> Complex {
        Complex::from(width * libm::exp(-PI * (width * omega).powi(2)))
    }

    #[test]
    fn gaussians_multiply_to_a_gaussian() {
        let lattice = Lattice::circle(60.0);
        let light = |[x, t]: [f64; 2]| bell(1.0, x) * bell(0.1, t);
        let width = (100.0_f64 + 4.0).sqrt().recip();
        for t in [0.0, 0.7, 5.0] {
            let got = angular_product(&lattice, [0.3, t], &|q| bell(0.5, q), &light);
            let expected = bell(1.0, 0.3) * bell(width, t);
            assert!((got - expected).norm() < 1e-15); // rounding
        }
    }
}
