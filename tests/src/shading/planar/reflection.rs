//! The seven steps of a reflection.

use super::product::{Lattice, TextureWave, angular_product, texture};
use etendue_field::Complex;
use etendue_theory::geometry::AffineMap;
use etendue_theory::shading::{PlanarLobe, cosine_hat};

/// The spectrum of a light field, L(Ωx, Ωθ).
type PlanarSpectrum<'a> = &'a dyn Fn([f64; 2]) -> Complex;

/// Steps of a reflection in the order of propagation (Durand et al. 2005, section 4.1 and Fig. 10).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ReflectionStep {
    /// Step 1, onto the surface: [`AffineMap::incidence`](AffineMap::<2>::incidence).
    Incidence,
    /// Step 2, into the frames of the local normals:
    /// [`AffineMap::curvature`](AffineMap::<2>::curvature).
    Curvature,
    /// Step 3, multiplication by the cosine and other factors of the direction of incidence.
    Cosine,
    /// Step 4, mirror reflection: [`AffineMap::mirror`].
    Mirror,
    /// Step 5, convolution with the lobe, and multiplication by factors of the outgoing direction.
    Brdf,
    /// Step 6, back from the local normals: [`AffineMap::back`](AffineMap::<2>::back).
    Back,
    /// Step 7, off the surface: [`AffineMap::outgoing`](AffineMap::<2>::outgoing).
    Outgoing,
}

impl ReflectionStep {
    /// All steps, in order.
    pub(crate) const ALL: [Self; 7] = [
        Self::Incidence,
        Self::Curvature,
        Self::Cosine,
        Self::Mirror,
        Self::Brdf,
        Self::Back,
        Self::Outgoing,
    ];
}

/// A factor that depends on the local direction and is given by its transform.
#[derive(Clone, Copy)]
pub(crate) enum Factor<'a> {
    /// The constant 1, which does not cut off light at the horizon. A surface with this factor and
    /// without a [`PlanarLobe`] is an ideal mirror. Its BRDF δ/cos θ_i' cancels the cosine.
    One,
    /// The clamped cosine cos⁺.
    Cosine,
    /// The transform f̂(Ω) of any other factor, which includes the cosine if needed, with Ω in
    /// cycles per radian. The transform of an asymmetric factor is complex.
    Other(&'a dyn Fn(f64) -> Complex),
}

impl Factor<'_> {
    /// The spectrum at Ω of the product of a light field and this factor.
    fn times(&self, lattice: &Lattice, omega: [f64; 2], before: PlanarSpectrum<'_>) -> Complex {
        match self {
            Self::One => before(omega),
            Self::Cosine => angular_product(lattice, omega, &|q| cosine_hat(q).into(), before),
            Self::Other(hat) => angular_product(lattice, omega, *hat, before),
        }
    }
}

/// A separable term of a BRDF, w(s) f(θ_i') ρ'(θ_o' − θ_r') h(θ_o').
#[derive(Clone, Copy)]
pub(crate) struct SeparableTerm<'a> {
    /// The factor f(θ_i'), including the cosine.
    pub(crate) before: Factor<'a>,
    /// The lobe ρ'; `None` represents a Dirac.
    pub(crate) lobe: Option<PlanarLobe>,
    /// The factor h(θ_o').
    pub(crate) after: Factor<'a>,
    /// The weight w(s), as a sum of waves; `None` represents the weight 1.
    pub(crate) weight: Option<&'a [TextureWave]>,
}

/// A reflection in 2D, from the light frame before the surface to the light frame after the
/// surface.
#[derive(Clone)]
pub(crate) struct PlanarReflection<'a> {
    /// θ₀, the direction from which the central ray comes, in radians from the normal.
    pub(crate) incidence: f64,
    /// θ₁, the direction in which the central ray leaves, in radians from the normal. For a mirror,
    /// θ₁ is −θ₀.
    pub(crate) outgoing: f64,
    /// Curvature k, in 1/m, convex positive.
    pub(crate) curvature: f64,
    /// The terms of the BRDF.
    pub(crate) terms: Vec<SeparableTerm<'a>>,
    /// Frequencies along Ωθ over which products are summed. These frequencies must reach beyond the
    /// spectrum of the light in the frames of the local normals.
    pub(crate) lattice: Lattice,
}

impl PlanarReflection<'_> {
    /// The spectrum at Ω after a step, for light with the spectrum `before` in the light
    /// frame.
    ///
    /// Like the [maps](etendue_theory::geometry), the spectrum holds to first order in the size of the
    /// neighbourhood. The effects of the cosine, the lobe and the factors are exact. If the BRDF
    /// has several terms, the spectrum between the cosine and the BRDF is the sum of the
    /// differential irradiances of all terms.
    ///
    /// For one term without h, the spectrum after step 6 is L_o(Ω) = ρ̂'(Ωθ) ∫ L_i(Ωx + k Ωθ − k q,
    /// q) f̂(−Ωθ − q) dq (docs/theory.md (36)). If f is asymmetric, the sign of −Ωθ affects the
    /// result. Table 1 of Durand et al. 2005 omits this sign and the hat of ρ̂', and Eqs. 15 and 17
    /// of the paper lack primes.
    pub(crate) fn spectrum(
        &self,
        step: ReflectionStep,
        omega: [f64; 2],
        before: PlanarSpectrum<'_>,
    ) -> Complex {
        let k = self.curvature;
        let until = |step: ReflectionStep| move |w: [f64; 2]| self.spectrum(step, w, before);
        match step {
            ReflectionStep::Incidence => {
                AffineMap::<2>::incidence(self.incidence).spectrum(omega, before)
            }
            ReflectionStep::Curvature => {
                AffineMap::<2>::curvature(k).spectrum(omega, &until(ReflectionStep::Incidence))
            }
            ReflectionStep::Cosine => self.sum(|term| self.lit(term, omega, before)),
            ReflectionStep::Mirror => {
                AffineMap::mirror().spectrum(omega, &until(ReflectionStep::Cosine))
            }
            ReflectionStep::Brdf => self.sum(|term| self.reflected(term, omega, before)),
            ReflectionStep::Back => {
                AffineMap::<2>::back(k).spectrum(omega, &until(ReflectionStep::Brdf))
            }
            ReflectionStep::Outgoing => AffineMap::<2>::outgoing(self.outgoing)
                .spectrum(omega, &until(ReflectionStep::Back)),
        }
    }

    fn sum(&self, of: impl Fn(&SeparableTerm<'_>) -> Complex) -> Complex {
        self.terms.iter().map(of).sum()
    }

    /// The spectrum at Ω after step 3, for one term of the BRDF.
    fn lit(
        &self,
        term: &SeparableTerm<'_>,
        omega: [f64; 2],
        before: PlanarSpectrum<'_>,
    ) -> Complex {
        let local = |w| self.spectrum(ReflectionStep::Curvature, w, before);
        term.before.times(&self.lattice, omega, &local)
    }

    /// The contribution of one term of the BRDF to the spectrum after step 5. The product
    /// with the lobe is Eq. 16 of Durand et al. 2005, and the weights of terms are textures
    /// (section 4.5).
    fn reflected(
        &self,
        term: &SeparableTerm<'_>,
        omega: [f64; 2],
        before: PlanarSpectrum<'_>,
    ) -> Complex {
        let mirrored = |w| AffineMap::mirror().spectrum(w, &|w| self.lit(term, w, before));
        let blurred = |w: [f64; 2]| match &term.lobe {
            Some(lobe) => mirrored(w) * lobe.spectrum(w[1]),
            None => mirrored(w),
        };
        let left = |w| term.after.times(&self.lattice, w, &blurred);
        match term.weight {
            Some(waves) => texture(waves, omega, &left),
            None => left(omega),
        }
    }
}
