//! The sampling criteria of glossy reflections. They say how fast a reflection varies across an
//! image.

/// The frequency below which 99 % of the energy of [`cosine_hat`](super::cosine_hat) lies, in
/// cycles per radian.
pub const COSINE_CUTOFF: f64 = 0.376;

/// The parameters that determine the bandwidth of a glossy surface's image in an environment
/// (Durand et al. 2005, section 6.2).
///
/// A bandwidth is the largest |Ωv| at a fixed point, the eye, in cycles per unit slope at the eye.
/// Unless d is zero, the formulas assume a distant eye and neglect the blur by the cosine,
/// [`COSINE_CUTOFF`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Criterion {
    /// Curvature k, in 1/m, convex positive. The sign affects the bandwidth: for a concave surface,
    /// the bandwidth first falls with the distance of the eye.
    pub curvature: f64,
    /// Angle of incidence θ₀ of the light, radians from the normal.
    pub incidence: f64,
    /// Angle θ₁ of the direction to the eye, radians from the normal.
    pub outgoing: f64,
    /// Distance d from the surface to the eye, metres.
    pub distance: f64,
    /// Distance d' from the surface to the blocker, metres; `None` if there is no blocker.
    pub blocker_distance: Option<f64>,
    /// Ω_ρ, the cutoff of the BRDF, in cycles per radian
    /// ([`PlanarLobe::cutoff`](super::PlanarLobe::cutoff)).
    pub lobe_cutoff: f64,
    /// Ω_e, the cutoff of the environment in cycles per radian.
    pub environment_cutoff: f64,
}

impl Criterion {
    /// The bandwidth Ω_ρ |1 + 2kd/cos θ₁|, which is Eq. 20 of Durand et al. 2005 extended
    /// to any distance. The environment is assumed to have light at all frequencies.
    #[must_use]
    pub fn environment(&self) -> f64 {
        self.lobe_cutoff * self.doubled_shear().abs()
    }

    /// The bandwidth of an edge before a uniform environment, which is Ω_ρ |1 + d (cos
    /// θ₀/d' + 2k)/cos θ₁|. This formula is Eq. 21 extended to any distance and angle.
    #[must_use]
    pub fn blocker(&self) -> f64 {
        self.lobe_cutoff * (self.doubled_shear() + self.edge()).abs()
    }

    /// An upper bound on the bandwidth of an edge before an environment with the cutoff
    /// Ω_e, which is Ω_ρ |1 + 2kd/cos θ₁| + d cos θ₀/(d' cos θ₁) (Ω_ρ + Ω_e).
    ///
    /// A small bright light behind an edge causes sharp shadows with any BRDF.
    /// [`blocker`](Self::blocker) does not cover this case.
    #[must_use]
    pub fn combined(&self) -> f64 {
        self.environment() + self.edge() * (self.lobe_cutoff + self.environment_cutoff)
    }

    /// The largest |Ωx| of the light that leaves the surface, where x is perpendicular to
    /// the ray and Ωx is in cycles per metre. With the blur by the cosine, this frequency is [cos
    /// θ₀/d' (Ω_ρ + Ω_cos + Ω_e) + 2|k| Ω_ρ + |k| Ω_cos]/cos θ₁.
    #[must_use]
    pub fn surface(&self) -> f64 {
        let behind = self.lobe_cutoff + COSINE_CUTOFF + self.environment_cutoff;
        let turned = self.curvature.abs() * (2.0 * self.lobe_cutoff + COSINE_CUTOFF);
        (self.nearness() * behind + turned) / libm::cos(self.outgoing)
    }

    /// The absolute value of Eq. 20 as printed, d 2k/cos θ₁ Ω_ρ. The printed equation is an
    /// approximation for a distant eye, which omits the term 1. The approximation requires a large
    /// |2kd/cos θ₁|, whereas the paper requires d ≫ 1.
    #[must_use]
    pub fn printed_environment(&self) -> f64 {
        self.lobe_cutoff * (self.doubled_shear() - 1.0).abs()
    }

    /// The bandwidth by Eq. 21 as printed, d/cos θ₁ (1/d' + 2k) Ω_ρ. As in the paper's
    /// text, |k| replaces k. The printed equation is an approximation for a distant eye and for
    /// light along the normal, so it omits the term 1 and the factor cos θ₀.
    #[must_use]
    pub fn printed_blocker(&self) -> f64 {
        let nearness = self.blocker_distance.map_or(0.0, f64::recip);
        let sum = nearness + 2.0 * self.curvature.abs();
        self.distance / libm::cos(self.outgoing) * sum * self.lobe_cutoff
    }

    /// Returns 1 + 2kd/cos θ₁, the effect of travel and of the two shears by the surface's
    /// curvature.
    fn doubled_shear(&self) -> f64 {
        1.0 + 2.0 * self.curvature * self.distance / libm::cos(self.outgoing)
    }

    /// Returns cos θ₀/d', which is the slope of the spectrum of an edge on a surface without
    /// curvature.
    fn nearness(&self) -> f64 {
        self.blocker_distance
            .map_or(0.0, |distance| libm::cos(self.incidence) / distance)
    }

    /// Returns d cos θ₀/(d' cos θ₁).
    fn edge(&self) -> f64 {
        self.distance * self.nearness() / libm::cos(self.outgoing)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares two numbers on a sphere: the samples per metre by Eq. 21, divided by Ω_ρ, and the
    /// error per metre of irradiance caching, Δ/R + √(1 − n·n₀) (Ward et al. 1988). Both formulas
    /// add a multiple of the curvature to the inverse harmonic mean distance: 2k in Eq. 21, and
    /// k/√2 in irradiance caching.
    #[test]
    fn eq_21_spaces_samples_as_irradiance_caching_does() {
        let step: f64 = 1e-3;
        for (distance, curvature) in [(0.3, 0.0), (2.0, 0.0), (0.5, 1.0), (2.0, 3.0)] {
            let criterion = Criterion {
                curvature,
                incidence: 0.4,
                outgoing: -0.4,
                distance: 7.0,
                blocker_distance: Some(distance),
                lobe_cutoff: 5.0,
                environment_cutoff: f64::INFINITY,
            };
            let on_screen = criterion.printed_blocker() / criterion.lobe_cutoff;
            let per_metre = on_screen * libm::cos(criterion.outgoing) / criterion.distance;
            let turned = (1.0 - libm::cos(curvature * step)).sqrt();
            let cached = (step / distance + turned) / step;
            let apart = per_metre - cached;
            let wanted = curvature * (2.0 - std::f64::consts::FRAC_1_SQRT_2);
            // The tolerance covers the expansion of the cosine to second order over a millimetre.
            assert!(
                (apart - wanted).abs() < 1e-5,
                "{distance} {curvature}: {apart}"
            );
        }
    }
}
