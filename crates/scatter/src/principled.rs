//! A mixture of a metal and a diffuse base below a dielectric interface, with few parameters
//! (Burley 2012, *Physically Based Shading at Disney*), in the form of Mitsuba's `principled`.

use crate::bsdf::before;
use crate::fresnel::Interface;
use crate::{Bsdf, Microfacets, lambertian};
use glam::DVec3;

/// The smallest share of directions that the facets sample, because Schlick's factor is larger at
/// grazing angles than the share of the lobe that is estimated.
const MIN_SHARE: f64 = 0.1;

/// The mixture at one point. All directions are in front of the surface.
#[derive(Clone, Copy, Debug)]
pub struct Principled {
    /// The facets of the metal and of the dielectric interface.
    pub facets: Microfacets,
    /// Index of the dielectric relative to the outside, at least 1.
    pub index: f64,
    /// Albedo of the base, and reflectance of the metal at normal incidence.
    pub color: f64,
    /// The share of the metal.
    pub metallic: f64,
    /// Burley's roughness of the base.
    pub roughness: f64,
}

impl Principled {
    /// Returns the contribution of the base to the BRDF. The base reflects more light back to where
    /// it comes from if it is rough, and less light at grazing angles if it is smooth (Burley 2012,
    /// section 5.3, with the retro-reflection apart as in Burley 2015, section 3).
    #[must_use]
    pub fn base_value(&self, wi: DVec3, wo: DVec3) -> f64 {
        let [i, o] = [wi, wo].map(|w| schlick(w.z));
        let half = (wi + wo).normalize().dot(wo);
        let retro = 2.0 * self.roughness * half * half;
        let shape = (1.0 - 0.5 * i) * (1.0 - 0.5 * o) + retro * (i + o + i * o * (retro - 1.0));
        self.base() * shape * lambertian::VALUE
    }

    /// Returns the albedo of the base times its share.
    #[must_use]
    pub fn base(&self) -> f64 {
        (1.0 - self.metallic) * self.color
    }

    /// Returns the reflectance of the facets at an angle of this cosine. Schlick's approximation
    /// describes the metal, and Fresnel's equations the dielectric.
    fn reflected(&self, cosine: f64) -> f64 {
        let metal = self.color + (1.0 - self.color) * schlick(cosine);
        let dielectric = Interface::new(self.index, cosine).reflected;
        self.metallic * metal + (1.0 - self.metallic) * dielectric
    }

    /// Returns the share of directions that are sampled by the facets: approximately their share of
    /// the light.
    fn facet_share(&self, wo: DVec3) -> f64 {
        let facets = self.reflected(wo.z);
        let base = self.base();
        if facets + base > 0.0 {
            (facets / (facets + base)).max(MIN_SHARE)
        } else {
            0.5
        }
    }
}

impl Bsdf for Principled {
    fn value(&self, wi: DVec3, wo: DVec3) -> f64 {
        if wi.z <= 0.0 {
            return 0.0;
        }
        let (value, cosine) = self.facets.value(wi, wo);
        value * self.reflected(cosine) + self.base_value(wi, wo)
    }

    fn density(&self, wi: DVec3, wo: DVec3) -> f64 {
        if wi.z <= 0.0 {
            return 0.0;
        }
        let share = self.facet_share(wo);
        share * self.facets.density(wi, wo) + (1.0 - share) * lambertian::density(wi)
    }

    fn direction(&self, wo: DVec3, [a, b, c]: [f64; 3]) -> Option<DVec3> {
        before(if c < self.facet_share(wo) {
            self.facets.sample(wo, [a, b])
        } else {
            lambertian::sample([a, b])
        })
    }
}

/// Returns (1 − cos)⁵, the weight in Schlick's approximation (Schlick 1994).
fn schlick(cosine: f64) -> f64 {
    let rest = (1.0 - cosine).clamp(0.0, 1.0);
    let squared = rest * rest;
    squared * squared * rest
}
