//! Lobes of a BRDF about the mirror direction.

use super::cosine::cosine_power_hat;
use super::panels::{doubling, even_transform};
use crate::quadrature::integrate;
use etendue_field::Lobe;
use std::f64::consts::{FRAC_PI_2, PI};

/// A lobe ρ'(δ) of unit integral over δ = θ_o' − θ_r', the angle from the mirror direction in 2D,
/// in radians (Durand et al. 2005, Eq. 15, which misprints θ_o' as θ_o).
///
/// Beckmann and GGX are models of narrow lobes. They are ρ' ∝ D(δ/2), where D is the distribution
/// of microfacet normals, because the tilt of a microfacet is half of δ. The factor 1/(4 cos θ_i'
/// cos θ_o') and the shadowing of a microfacet BRDF are omitted, because they are not functions of
/// δ alone. The Fresnel factor ([`fresnel_reflectance`](super::fresnel_reflectance)) is omitted for the same
/// reason. The distributions D are slices of the 3D distributions through the plane of incidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlanarLobe {
    /// The lobe cosⁿ δ on |δ| < π/2.
    Phong {
        /// Exponent n > 0.
        exponent: f64,
    },
    /// exp(−δ²/2σ²).
    Gaussian {
        /// Standard deviation σ > 0, in radians.
        deviation: f64,
    },
    /// The lobe exp(−tan² τ/α²)/cos⁴ τ, τ = δ/2 (Beckmann and Spizzichino 1963).
    Beckmann {
        /// Roughness α > 0, the root mean square slope of microfacets times √2.
        roughness: f64,
    },
    /// The lobe 1/(α² cos² τ + sin² τ)², τ = δ/2 (GGX; Walter et al. 2007, Eq. 33).
    Ggx {
        /// Roughness 0 < α ≤ 1.
        roughness: f64,
    },
}

impl PlanarLobe {
    /// The model in 2D of a lobe about the mirror direction; `None` for a lobe about the normal.
    #[must_use]
    pub fn of(lobe: Lobe) -> Option<Self> {
        match lobe {
            Lobe::Lambertian => None,
            Lobe::Phong { exponent } => Some(Self::Phong { exponent }),
            Lobe::Beckmann { roughness } => Some(Self::Beckmann { roughness }),
            Lobe::Ggx { roughness } => Some(Self::Ggx { roughness }),
        }
    }

    /// The variance of the angle from the mirror direction, in radians squared.
    ///
    /// Phong's cosⁿ is a Gaussian of variance 1/n, to first order in 1/n. A microfacet that is
    /// tilted by τ turns light by 2τ, so the variance of a Beckmann lobe is 2α². A GGX lobe has no
    /// variance; 5α²/3 corresponds to the variance of its power spectrum.
    pub(crate) fn variance(&self) -> f64 {
        match *self {
            Self::Phong { exponent } => 1.0 / exponent,
            Self::Gaussian { deviation } => deviation * deviation,
            Self::Beckmann { roughness } => 2.0 * roughness * roughness,
            Self::Ggx { roughness } => 5.0 / 3.0 * roughness * roughness,
        }
    }

    /// Returns ρ'(δ), per radian.
    #[must_use]
    pub fn value(&self, angle: f64) -> f64 {
        match *self {
            Self::Phong { exponent } => {
                let inside = angle.abs() < FRAC_PI_2;
                let power = if inside {
                    libm::pow(libm::cos(angle), exponent)
                } else {
                    0.0
                };
                power / cosine_power_hat(exponent, 0.0)
            }
            Self::Gaussian { deviation } => {
                let z = angle / deviation;
                libm::exp(-0.5 * z * z) / (deviation * (2.0 * PI).sqrt())
            }
            Self::Beckmann { roughness } => {
                let Some(t) = slope(angle) else { return 0.0 };
                let area = PI.sqrt() * roughness * (2.0 + roughness * roughness);
                let z = t / roughness;
                (1.0 + t * t).powi(2) * libm::exp(-z * z) / area
            }
            Self::Ggx { roughness } => {
                if angle.abs() > PI {
                    return 0.0;
                }
                let (sine, cosine) = libm::sincos(0.5 * angle);
                let a = roughness * roughness;
                let area = PI * (1.0 + a) / (a * roughness);
                (a * cosine * cosine + sine * sine).powi(-2) / area
            }
        }
    }

    /// The spectrum ρ̂'(Ω) of the lobe, with Ω in cycles per radian (Durand et al. 2005,
    /// Eq. 16). The spectrum is real and even, and 1 at zero.
    ///
    /// The spectrum of a Phong lobe is Γ(1 + n/2)²/(Γ(1 + n/2 + πΩ) Γ(1 + n/2 − πΩ)), and the
    /// spectrum of a Gaussian lobe is exp(−2π²σ²Ω²). The spectra of Beckmann and GGX lobes are
    /// computed by quadrature, to 10⁻¹².
    #[must_use]
    pub fn spectrum(&self, omega: f64) -> f64 {
        match *self {
            Self::Phong { exponent } => {
                cosine_power_hat(exponent, omega) / cosine_power_hat(exponent, 0.0)
            }
            Self::Gaussian { deviation } => libm::exp(-2.0 * (PI * deviation * omega).powi(2)),
            Self::Beckmann { .. } | Self::Ggx { .. } => {
                even_transform(&self.ends(), omega, |angle| self.value(angle))
            }
        }
    }

    /// The frequency below which a share of the energy ∫ |ρ̂'|² dΩ lies, in cycles per
    /// radian. `fraction` is this share and is in (0, 1).
    ///
    /// For a Gaussian lobe the frequency is 0.2899/σ for 99 % and 0.2206/σ for 95 %. Durand et al.
    /// 2005, section 6.2, call this frequency Ω_ρ and choose it by hand. The frequency is computed
    /// by summation, to 10⁻⁹. A lobe with a discontinuity, such as GGX at its end, may have a
    /// millionth of its energy beyond the searched range. If the requested share includes this
    /// energy, the result is NaN.
    #[must_use]
    pub fn cutoff(&self, fraction: f64) -> f64 {
        const NODES: usize = 16;
        const MAX_PANELS: u32 = 4000;
        let step = 0.05 / self.width();
        let energy = |low: f64, high: f64| {
            2.0 * integrate(NODES, [low, high], |omega| self.spectrum(omega).powi(2))
        };
        let mut missing = fraction * self.energy();
        for panel in 0..MAX_PANELS {
            let low = f64::from(panel) * step;
            let next = energy(low, low + step);
            if next < missing {
                missing -= next;
                continue;
            }
            // Bisects until the interval is as small as rounding error.
            let (mut inside, mut outside) = (low, low + step);
            for _ in 0..50 {
                let middle = 0.5 * (inside + outside);
                if energy(low, middle) < missing {
                    inside = middle;
                } else {
                    outside = middle;
                }
            }
            return inside;
        }
        f64::NAN
    }

    /// ∫ |ρ̂'|² dΩ = ∫ ρ'² dδ (Parseval).
    fn energy(&self) -> f64 {
        match *self {
            Self::Phong { exponent } => {
                cosine_power_hat(2.0 * exponent, 0.0) / cosine_power_hat(exponent, 0.0).powi(2)
            }
            Self::Gaussian { deviation } => 0.5 / (deviation * PI.sqrt()),
            Self::Beckmann { .. } | Self::Ggx { .. } => {
                even_transform(&self.ends(), 0.0, |angle| self.value(angle).powi(2))
            }
        }
    }

    /// The width of the lobe from which step sizes are derived.
    fn width(&self) -> f64 {
        match *self {
            Self::Phong { exponent } => exponent.max(1.0).sqrt().recip(),
            Self::Gaussian { deviation } => deviation,
            Self::Beckmann { roughness } | Self::Ggx { roughness } => roughness,
        }
    }

    /// The ends of panels over half of the lobe. The poles of GGX are at about 2α, which is
    /// also the width of Beckmann's lobe.
    fn ends(&self) -> Vec<f64> {
        doubling(self.width(), PI)
    }
}

/// Returns tan(δ/2); `None` if this slope is too large for any microfacet.
fn slope(angle: f64) -> Option<f64> {
    let t = libm::tan(0.5 * angle);
    (angle.abs() < PI && t.abs() < 1e100).then_some(t)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOBES: [PlanarLobe; 8] = [
        PlanarLobe::Phong { exponent: 1.0 },
        PlanarLobe::Phong { exponent: 40.0 },
        PlanarLobe::Gaussian { deviation: 0.1 },
        PlanarLobe::Beckmann { roughness: 0.05 },
        PlanarLobe::Beckmann { roughness: 0.4 },
        PlanarLobe::Ggx { roughness: 0.02 },
        PlanarLobe::Ggx { roughness: 0.3 },
        PlanarLobe::Ggx { roughness: 1.0 },
    ];

    #[test]
    fn unit_integrals_and_transforms() {
        for lobe in LOBES {
            assert!((lobe.spectrum(0.0) - 1.0).abs() < 1e-12, "{lobe:?}"); // the stated error
            for omega in [0.0, 0.3, 2.0, 11.0] {
                // The trapezoid rule converges exponentially for functions that vanish at the ends,
                // and for functions that are periodic because 2πΩ is an integer.
                if matches!(lobe, PlanarLobe::Ggx { .. } | PlanarLobe::Phong { .. }) && omega != 0.0
                {
                    continue;
                }
                let count = 20_000;
                let step = 2.0 * PI / f64::from(count);
                let sum: f64 = (0..count)
                    .map(|i| {
                        let at = f64::from(i) * step - PI;
                        lobe.value(at) * libm::cos(2.0 * PI * omega * at) * step
                    })
                    .sum();
                // The corner of cos δ causes an error of step²/6, which is 3e-8.
                let close = if lobe == LOBES[0] { 3e-8 } else { 1e-12 };
                assert!((sum - lobe.spectrum(omega)).abs() < close, "{lobe:?}");
            }
        }
    }

    #[test]
    fn ggx_at_whole_numbers_of_the_circle() {
        // The function 1/(p − q cos δ)² is a derivative of a Poisson kernel, and has the Fourier
        // coefficients rⁿ (1 + n s), s = √(p² − q²)/p.
        let alpha: f64 = 0.3;
        let lobe = PlanarLobe::Ggx { roughness: alpha };
        let a = alpha * alpha;
        let (p, q) = (0.5 * (1.0 + a), 0.5 * (1.0 - a));
        let root = (p * p - q * q).sqrt();
        for n in 0..30 {
            let n = f64::from(n);
            let expected = libm::pow((p - root) / q, n) * (1.0 + n * root / p);
            let got = lobe.spectrum(n / (2.0 * PI));
            assert!((got - expected).abs() < 1e-12, "{n}: {got} {expected}"); // the stated error
        }
    }

    #[test]
    fn cutoffs_of_a_gaussian() {
        let lobe = PlanarLobe::Gaussian { deviation: 0.05 };
        // The expected cutoffs are the quantiles of the normal distribution at 99 % and 95 %,
        // divided by 2√2 πσ.
        for (fraction, quantile) in [(0.99, 2.575_829_303_5), (0.95, 1.959_963_984_5)] {
            let expected = quantile / (2.0 * 2.0_f64.sqrt() * PI * 0.05);
            assert!((lobe.cutoff(fraction) / expected - 1.0).abs() < 1e-9); // the stated error
        }
        // A Phong lobe is nearly a Gaussian of σ² = 1/n.
        let phong = PlanarLobe::Phong { exponent: 400.0 }.cutoff(0.99);
        assert!((phong / (0.29 * 20.0) - 1.0).abs() < 5e-3); // 0.27/n of ρ̂ in the tail
    }

    #[test]
    fn beyond_the_poles_a_phong_lobe_still_has_a_spectrum() {
        let lobe = PlanarLobe::Phong { exponent: 5.0 };
        let at = |omega| even_transform(&[0.0, 0.8, 1.4, FRAC_PI_2], omega, |t| lobe.value(t));
        for omega in [1.0, 1.2, 2.0, 7.5 / PI, 9.5 / PI] {
            assert!((lobe.spectrum(omega) - at(omega)).abs() < 1e-13, "{omega}"); // rounding
        }
        assert!(lobe.spectrum(2.0).abs() > 1e-5);
    }
}
