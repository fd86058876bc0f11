//! Defines smooth and rough transmitting interfaces between two media. wo is in front of the
//! interface. `index` is the refractive index of the far side, divided by the refractive index of
//! the side of wo.
//!
//! Values refer to radiance, which is larger on the far side by the squared index.

use crate::bsdf::mirrored;
use crate::fresnel::Interface;
use crate::{Bsdf, BsdfSample, Microfacets};
use glam::DVec3;

/// A smooth interface, or a thin sheet with such an interface on both sides.
#[derive(Clone, Copy, Debug)]
pub struct SmoothDielectric {
    /// Relative index of refraction.
    pub index: f64,
    /// Whether this is a thin sheet: light goes straight through, and all internal reflections are
    /// summed.
    pub is_thin: bool,
}

impl SmoothDielectric {
    /// Reflects or refracts light; the probability of each event is its share of the light.
    #[inline]
    #[must_use]
    pub fn sample(&self, wo: DVec3, random: f64) -> BsdfSample {
        let at = Interface::new(self.index, wo.z);
        let once = at.reflected;
        let reflected = if self.is_thin && once < 1.0 {
            // R + T² R / (1 − R²).
            once + (1.0 - once).powi(2) * once / (1.0 - once * once)
        } else {
            once
        };
        if random < reflected {
            BsdfSample::only(mirrored(wo, DVec3::Z), 1.0)
        } else if self.is_thin {
            BsdfSample::only(-wo, 1.0)
        } else {
            let weight = 1.0 / (self.index * self.index);
            BsdfSample::only(at.refracted(wo, DVec3::Z), weight)
        }
    }
}

/// A rough interface (Walter et al. 2007, section 4).
#[derive(Clone, Copy, Debug)]
pub struct RoughDielectric {
    /// The microfacets.
    pub facets: Microfacets,
    /// Relative index of refraction.
    pub index: f64,
}

/// A microfacet that reflects or refracts between two directions.
#[derive(Clone, Copy, Debug)]
struct Facet {
    normal: DVec3,
    /// Cosines of wi and wo to the normal.
    cosines: [f64; 2],
    /// The share of light that the facet reflects.
    reflected: f64,
}

impl RoughDielectric {
    /// The facet at which wo is mirrored or refracted to wi (Walter et al., Eqs. 13 and
    /// 16). Returns `None` if this facet does not face the front.
    #[inline]
    fn facet(&self, wi: DVec3, wo: DVec3) -> Option<Facet> {
        let eta = if wi.z > 0.0 { 1.0 } else { self.index };
        let normal = (wo + eta * wi).try_normalize()?;
        let normal = if normal.z < 0.0 { -normal } else { normal };
        let [i, o] = [wi.dot(normal), wo.dot(normal)];
        // The facet must be visible from both directions, and each direction must see it from its
        // own side.
        (o > 0.0 && i * wi.z > 0.0).then(|| Facet {
            normal,
            cosines: [i, o],
            reflected: Interface::new(self.index, o).reflected,
        })
    }
}

impl Bsdf for RoughDielectric {
    /// Implements Eqs. 20 and 21 of Walter et al.
    #[inline]
    fn value(&self, wi: DVec3, wo: DVec3) -> f64 {
        let Some(facet) = self.facet(wi, wo) else {
            return 0.0;
        };
        let [i, o] = facet.cosines;
        let masking = self.facets.g1(wi) * self.facets.g1(wo);
        let common = self.facets.d(facet.normal) * masking / (wi.z.abs() * wo.z);
        if wi.z > 0.0 {
            return 0.25 * facet.reflected * common;
        }
        let sum = o + self.index * i;
        // Radiance on the far side is divided by the squared index, and solid angles there are
        // smaller by the same factor.
        (1.0 - facet.reflected) * common * (o * i).abs() / (sum * sum)
    }

    /// Implements Eqs. 14 and 17 of Walter et al.
    #[inline]
    fn density(&self, wi: DVec3, wo: DVec3) -> f64 {
        let Some(facet) = self.facet(wi, wo) else {
            return 0.0;
        };
        let [i, o] = facet.cosines;
        let of_normal = self.facets.normal_density(wo, facet.normal);
        if wi.z > 0.0 {
            return facet.reflected * of_normal / (4.0 * o);
        }
        let sum = o + self.index * i;
        (1.0 - facet.reflected) * of_normal * self.index * self.index * i.abs() / (sum * sum)
    }

    /// Mirrors or refracts a direction at a facet, with the shares of light as probabilities;
    /// `None` if light would meet another facet.
    #[inline]
    fn direction(&self, wo: DVec3, [a, b, c]: [f64; 3]) -> Option<DVec3> {
        let normal = self.facets.sample_normal(wo, [a, b]);
        let at = Interface::new(self.index, wo.dot(normal));
        let is_reflected = c < at.reflected;
        let wi = if is_reflected {
            mirrored(wo, normal)
        } else {
            at.refracted(wo, normal)
        };
        ((wi.z > 0.0) == is_reflected).then_some(wi)
    }
}
