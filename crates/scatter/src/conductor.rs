//! Conductors: a smooth mirror, or mirror microfacets.

use crate::bsdf::before;
use crate::{Bsdf, BsdfSample, Microfacets, fresnel};
use etendue_field::Fresnel;
use glam::DVec3;

/// The light that a smooth mirror reflects along wo, which is in front of it.
#[inline]
#[must_use]
pub fn mirror(fresnel: &Fresnel, wo: DVec3) -> BsdfSample {
    let weight = fresnel::reflectance(fresnel, wo.z.min(1.0));
    BsdfSample::only(DVec3::new(-wo.x, -wo.y, wo.z), weight)
}

/// A rough mirror, whose facets are sampled by their visibility from wo.
#[derive(Clone, Copy, Debug)]
pub struct Conductor {
    /// The microfacets.
    pub facets: Microfacets,
    /// The Fresnel reflectance of each microfacet.
    pub fresnel: Fresnel,
}

impl Bsdf for Conductor {
    #[inline]
    fn value(&self, wi: DVec3, wo: DVec3) -> f64 {
        if wi.z <= 0.0 {
            return 0.0;
        }
        let (value, cosine) = self.facets.value(wi, wo);
        value * fresnel::reflectance(&self.fresnel, cosine)
    }

    #[inline]
    fn density(&self, wi: DVec3, wo: DVec3) -> f64 {
        before(wi).map_or(0.0, |wi| self.facets.density(wi, wo))
    }

    #[inline]
    fn direction(&self, wo: DVec3, [a, b, _]: [f64; 3]) -> Option<DVec3> {
        before(self.facets.sample(wo, [a, b]))
    }
}
