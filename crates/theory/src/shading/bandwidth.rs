//! How fast a glossy reflection changes across an image.

/// The frequency below which 99 % of the energy of [`cosine_hat`](super::cosine_hat) lies, in
/// cycles per radian.
pub const COSINE_CUTOFF: f64 = 0.376;

/// What the image of a glossy surface in some environment is made of (Durand et al. 2005, section
/// 6.2).
///
/// Bandwidths are the largest |Ωv| at a fixed point, which is the eye, in cycles per unit slope
/// there. The eye is the larger scale: where d is not zero the blur by the cosine,
/// [`COSINE_CUTOFF`], is neglected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Criterion {
    /// k, in 1/m, convex positive. Its sign matters: a concave surface first undoes what travel
    /// does.
    pub curvature: f64,
    /// θ₀, where the light comes from, radians from the normal.
    pub incidence: f64,
    /// θ₁, where the eye is, radians from the normal.
    pub outgoing: f64,
    /// d, metres from the surface to the eye.
    pub distance: f64,
    /// d', metres from the surface to what blocks the light; `None` if nothing does.
    pub blocker_distance: Option<f64>,
    /// Ω_ρ, the cutoff of the BRDF in cycles per radian: [`PlanarLobe::cutoff`](super::PlanarLobe::cutoff).
    pub lobe_cutoff: f64,
    /// Ω_e, the cutoff of the environment in cycles per radian.
    pub environment_cutoff: f64,
}

impl Criterion {
    /// Eq. 20 of Durand et al. 2005, at any distance: Ω_ρ |1 + 2kd/cos θ₁|, for an environment with
    /// content at all frequencies.
    #[must_use]
    pub fn environment(&self) -> f64 {
        self.lobe_cutoff * self.doubled_shear().abs()
    }

    /// The same for an environment that ends at Ω_e: the lower of both cutoffs instead of Ω_ρ.
    #[must_use]
    pub fn limited_environment(&self) -> f64 {
        self.lobe_cutoff.min(self.environment_cutoff) * self.doubled_shear().abs()
    }

    /// An edge before an even environment: Ω_ρ |1 + d (cos θ₀/d' + 2k)/cos θ₁|. Eq. 21
    /// at any distance and angle.
    #[must_use]
    pub fn blocker(&self) -> f64 {
        self.lobe_cutoff * (self.doubled_shear() + self.edge()).abs()
    }

    /// An edge before an environment that ends at Ω_e, at most: Ω_ρ |1 + 2kd/cos θ₁| + d cos θ₀/(d'
    /// cos θ₁) (Ω_ρ + Ω_e).
    ///
    /// A small bright light behind an edge makes shadows sharp on any BRDF, which
    /// [`blocker`](Self::blocker) does not see.
    #[must_use]
    pub fn combined(&self) -> f64 {
        self.environment() + self.edge() * (self.lobe_cutoff + self.environment_cutoff)
    }

    /// The largest |Ωx| of the light that leaves the surface, across it and in cycles per metre,
    /// with the blur of the cosine: [cos θ₀/d' (Ω_ρ + Ω_cos + Ω_e) + 2|k| Ω_ρ + |k| Ω_cos]/cos θ₁.
    #[must_use]
    pub fn surface(&self) -> f64 {
        let behind = self.lobe_cutoff + COSINE_CUTOFF + self.environment_cutoff;
        let turned = self.curvature.abs() * (2.0 * self.lobe_cutoff + COSINE_CUTOFF);
        (self.nearness() * behind + turned) / libm::cos(self.outgoing)
    }

    /// Eq. 20 as printed, d 2k/cos θ₁ Ω_ρ, as a size: an approximation for a far eye, without the 1.
    /// What must be large is |2kd/cos θ₁|; the paper says d ≫ 1.
    #[must_use]
    pub fn printed_environment(&self) -> f64 {
        self.lobe_cutoff * (self.doubled_shear() - 1.0).abs()
    }

    /// Eq. 21 as printed, d/cos θ₁ (1/d' + 2k) Ω_ρ, with |k|, as the text says: an
    /// approximation for a far eye and light along the normal, without the 1 and cos θ₀.
    #[must_use]
    pub fn printed_blocker(&self) -> f64 {
        let nearness = self.blocker_distance.map_or(0.0, f64::recip);
        let sum = nearness + 2.0 * self.curvature.abs();
        self.distance / libm::cos(self.outgoing) * sum * self.lobe_cutoff
    }

    /// 1 + 2kd/cos θ₁: both shears of the surface, then travel.
    fn doubled_shear(&self) -> f64 {
        1.0 + 2.0 * self.curvature * self.distance / libm::cos(self.outgoing)
    }

    /// cos θ₀/d': the slope of the spectrum of an edge on the surface, without curvature.
    fn nearness(&self) -> f64 {
        self.blocker_distance
            .map_or(0.0, |distance| libm::cos(self.incidence) / distance)
    }

    /// d cos θ₀/(d' cos θ₁).
    fn edge(&self) -> f64 {
        self.distance * self.nearness() / libm::cos(self.outgoing)
    }
}
