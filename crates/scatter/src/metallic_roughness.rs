//! The metallic-roughness model of glTF 2.0 (Appendix B): a mixture of a metal, and of a diffuse
//! base below a dielectric coat.

use crate::bsdf::{before, mirrored};
use crate::principled::{MIN_SHARE, schlick};
use crate::{Bsdf, BsdfSample, Microfacets, lambertian};
use glam::DVec3;

/// The mixture at one point. wo is in front of the surface.
#[derive(Clone, Copy, Debug)]
pub struct MetallicRoughness {
    /// The facets of the metal and of the coat; `None` if both are smooth.
    pub facets: Option<Microfacets>,
    /// Albedo of the base, and reflectance of the metal at normal incidence.
    pub color: f64,
    /// The share of the metal.
    pub metallic: f64,
    /// Reflectance of the coat at normal and at grazing incidence.
    pub coat: [f64; 2],
}

impl MetallicRoughness {
    /// The contribution of the base to the BRDF: Lambert's BRDF less the reflectance of the
    /// coat, at the angle between wo and the half vector.
    #[must_use]
    pub fn base_value(&self, wi: DVec3, wo: DVec3) -> f64 {
        let cosine = (wi + wo).normalize().dot(wo);
        self.base() * (1.0 - raised(self.coat, cosine)) * lambertian::VALUE
    }

    /// The albedo of the base times its share.
    #[must_use]
    pub fn base(&self) -> f64 {
        (1.0 - self.metallic) * self.color
    }

    /// The reflectance of the facets at an angle of this cosine.
    fn reflected(&self, cosine: f64) -> f64 {
        let metal = raised([self.color, 1.0], cosine);
        self.metallic * metal + (1.0 - self.metallic) * raised(self.coat, cosine)
    }

    /// The share of directions that the facets sample: approximately their share of the
    /// light.
    fn facet_share(&self, wo: DVec3) -> f64 {
        let facets = self.reflected(wo.z);
        let base = self.base() * (1.0 - raised(self.coat, wo.z));
        if base <= 0.0 {
            return 1.0;
        }
        (facets / (facets + base)).max(MIN_SHARE)
    }
}

impl Bsdf for MetallicRoughness {
    fn value(&self, wi: DVec3, wo: DVec3) -> f64 {
        if wi.z <= 0.0 {
            return 0.0;
        }
        let facets = self.facets.map_or(0.0, |facets| {
            let (value, cosine) = facets.value(wi, wo);
            value * self.reflected(cosine)
        });
        facets + self.base_value(wi, wo)
    }

    fn density(&self, wi: DVec3, wo: DVec3) -> f64 {
        if wi.z <= 0.0 {
            return 0.0;
        }
        let share = self.facet_share(wo);
        let facets = self.facets.map_or(0.0, |facets| facets.density(wi, wo));
        share * facets + (1.0 - share) * lambertian::density(wi)
    }

    fn direction(&self, wo: DVec3, [a, b, c]: [f64; 3]) -> Option<DVec3> {
        if c < self.facet_share(wo) {
            before(self.facets?.sample(wo, [a, b]))
        } else {
            Some(lambertian::sample([a, b]))
        }
    }

    fn mirrored(&self, wo: DVec3, c: f64) -> Option<BsdfSample> {
        let share = self.facet_share(wo);
        (self.facets.is_none() && c < share)
            .then(|| BsdfSample::only(mirrored(wo, DVec3::Z), self.reflected(wo.z) / share))
    }
}

/// Schlick's reflectance, given its values at normal and at grazing incidence.
fn raised([normal, grazing]: [f64; 2], cosine: f64) -> f64 {
    normal + (grazing - normal) * schlick(cosine)
}
