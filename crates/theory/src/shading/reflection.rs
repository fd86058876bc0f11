//! The seven steps of a reflection.

use super::product::{Lattice, angular_product};
use super::{Fresnel, Lobe, cosine_hat};
use crate::geometry::Map;
use etendue_field::Complex;
use std::fmt;

/// The spectrum of a light field, L(Ωx, Ωθ).
type Spectrum<'a> = &'a dyn Fn([f64; 2]) -> Complex;

/// Steps of a reflection in the order of light (Durand et al. 2005, section 4.1 and Fig. 10).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// 1, onto the surface: [`Map::incidence`](Map::<2>::incidence).
    Incidence,
    /// 2, into the frames of the local normals: [`Map::curvature`](Map::<2>::curvature).
    Curvature,
    /// 3, times cosine and other factors of the direction of incidence.
    Cosine,
    /// 4, mirrored: [`Map::mirror`].
    Mirror,
    /// 5, convolved with the lobe, times factors of the outgoing direction.
    Brdf,
    /// 6, back from the local normals: [`Map::back`](Map::<2>::back).
    Back,
    /// 7, off the surface: [`Map::outgoing`](Map::<2>::outgoing).
    Outgoing,
}

impl Step {
    /// All, in order.
    pub const ALL: [Self; 7] = [
        Self::Incidence,
        Self::Curvature,
        Self::Cosine,
        Self::Mirror,
        Self::Brdf,
        Self::Back,
        Self::Outgoing,
    ];
}

/// A factor of a local direction, as its transform.
#[derive(Clone, Copy)]
pub enum Factor<'a> {
    /// 1: none. With no [`Lobe`] this is an ideal mirror, whose BRDF δ/cos θ_i' cancels the cosine.
    One,
    /// cos⁺.
    Cosine,
    /// Fresnel reflectance times cos⁺.
    Fresnel(Fresnel),
    /// Any other, the cosine included where one is due: f̂(Ω), in cycles per radian. Asymmetric ones are complex.
    Other(&'a dyn Fn(f64) -> Complex),
}

impl fmt::Debug for Factor<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::One => write!(f, "One"),
            Self::Cosine => write!(f, "Cosine"),
            Self::Fresnel(fresnel) => f.debug_tuple("Fresnel").field(fresnel).finish(),
            Self::Other(_) => write!(f, "Other"),
        }
    }
}

impl Factor<'_> {
    /// The spectrum of the product at Ω.
    fn times(&self, lattice: &Lattice, omega: [f64; 2], before: Spectrum<'_>) -> Complex {
        match self {
            Self::One => before(omega),
            Self::Cosine => product(lattice, omega, &|q| cosine_hat(q).into(), before),
            Self::Fresnel(f) => product(lattice, omega, &|q| f.cosine_hat(q).into(), before),
            Self::Other(hat) => product(lattice, omega, *hat, before),
        }
    }
}

use angular_product as product;

/// One separable term of a BRDF, f(θ_i') ρ'(θ_o' − θ_r') h(θ_o').
#[derive(Clone, Copy, Debug)]
pub struct Term<'a> {
    /// f(θ_i') with the cosine.
    pub before: Factor<'a>,
    /// ρ'; `None` is a Dirac.
    pub lobe: Option<Lobe>,
    /// h(θ_o').
    pub after: Factor<'a>,
}

/// Reflection in 2D, from the light frame before to the light frame after.
#[derive(Clone, Debug)]
pub struct Reflection<'a> {
    /// θ₀, where the central light comes from; radians from the normal.
    pub incidence: f64,
    /// θ₁, where the central ray leaves; −θ₀ for a mirror.
    pub outgoing: f64,
    /// k, in 1/m, convex positive.
    pub curvature: f64,
    /// The BRDF, as a sum.
    pub terms: Vec<Term<'a>>,
    /// Frequencies along Ωθ at which products are summed. Its reach covers the content of the light in the frames of the local normals.
    pub lattice: Lattice,
}

impl Reflection<'_> {
    /// The spectrum at Ω after a step, of light with the spectrum `before` in the light frame.
    ///
    /// To first order in the size of the neighbourhood, as are the [maps](crate::geometry); cosine, lobe and factors are exact. Between the
    /// cosine and the BRDF a sum of terms is that of their differential irradiances.
    ///
    /// L_o(Ω) = ρ̂'(Ωθ) ∫ L_i(Ωx + k Ωθ − k q, q) f̂(−Ωθ − q) dq after step 6 for one term without h (docs/theory.md, Eq. 36). For an asymmetric f that is
    /// f̂(−Ωθ), of which Table 1 of Durand et al. 2005 drops the sign; their Eqs. 15 to 17 lack primes and hats.
    #[must_use]
    pub fn spectrum(&self, step: Step, omega: [f64; 2], before: Spectrum<'_>) -> Complex {
        let k = self.curvature;
        let until = |step: Step| move |w: [f64; 2]| self.spectrum(step, w, before);
        match step {
            Step::Incidence => Map::<2>::incidence(self.incidence).spectrum(omega, before),
            Step::Curvature => Map::<2>::curvature(k).spectrum(omega, &until(Step::Incidence)),
            Step::Cosine => self.sum(|term| self.lit(term, omega, before)),
            Step::Mirror => Map::mirror().spectrum(omega, &until(Step::Cosine)),
            Step::Brdf => self.sum(|term| self.reflected(term, omega, before)),
            Step::Back => Map::<2>::back(k).spectrum(omega, &until(Step::Brdf)),
            Step::Outgoing => Map::<2>::outgoing(self.outgoing).spectrum(omega, &until(Step::Back)),
        }
    }

    fn sum(&self, of: impl Fn(&Term<'_>) -> Complex) -> Complex {
        self.terms.iter().map(of).sum()
    }

    /// Step 3 of a term.
    fn lit(&self, term: &Term<'_>, omega: [f64; 2], before: Spectrum<'_>) -> Complex {
        let local = |w| self.spectrum(Step::Curvature, w, before);
        term.before.times(&self.lattice, omega, &local)
    }

    /// Steps 3 to 5 of a term.
    fn reflected(&self, term: &Term<'_>, omega: [f64; 2], before: Spectrum<'_>) -> Complex {
        let mirrored = |w| Map::mirror().spectrum(w, &|w| self.lit(term, w, before));
        let blurred = |w: [f64; 2]| match &term.lobe {
            Some(lobe) => mirrored(w) * lobe.spectrum(w[1]),
            None => mirrored(w),
        };
        term.after.times(&self.lattice, omega, &blurred)
    }
}
