//! A mixture of a metal and a diffuse base below a dielectric interface, with few parameters
//! (Burley 2012, *Physically Based Shading at Disney*), in the form of Mitsuba's `principled`.

use crate::bsdf::{before, mirrored};
use crate::fresnel::Interface;
use crate::{Bsdf, Microfacets, RoughDielectric, lambertian};
use etendue_field::{MicrofacetDistribution, power, sincos_turns};
use glam::DVec3;
use std::f64::consts::PI;

/// The smallest share of directions that the facets sample, because Schlick's factor is larger at
/// grazing angles than the share of the lobe that is estimated.
pub(crate) const MIN_SHARE: f64 = 0.1;

/// The mixture at one point. wo is in front of the surface.
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
    /// The share of the base that is replaced by light through the interface.
    pub transmission: f64,
    /// Burley's roughness of the base.
    pub roughness: f64,
    /// The share of Schlick's approximation in the reflectance of the interface.
    pub tint: f64,
    /// The share of flat subsurface scattering in the base.
    pub flatness: f64,
    /// The strength of an additional reflection at grazing angles, like the reflection by cloth.
    pub sheen: f64,
    /// The strength of the clear coat.
    pub clearcoat: f64,
    /// The roughness α of the clear coat, below 1.
    pub coat_alpha: f64,
}

impl Principled {
    /// The contribution of the base to the BRDF. A rough base reflects more light back to
    /// where the light comes from, and a smooth base reflects less light at grazing angles (Burley
    /// 2012, section 5.3; Burley 2015, *Extending the Disney BRDF to a BSDF with integrated
    /// subsurface scattering*, section 3).
    #[must_use]
    pub fn base_value(&self, wi: DVec3, wo: DVec3) -> f64 {
        let [i, o] = [wi, wo].map(|w| schlick(w.z));
        let half = (wi + wo).normalize().dot(wo);
        let retro = 2.0 * self.roughness * half * half;
        let diffuse = (1.0 - 0.5 * i) * (1.0 - 0.5 * o) + retro * (i + o + i * o * (retro - 1.0));
        let grazing = |weight: f64| 1.0 + (0.5 * retro - 1.0) * weight;
        let flat = 1.25 * (grazing(i) * grazing(o) * (1.0 / (wi.z + wo.z) - 0.5) + 0.5);
        let shape = diffuse + self.flatness * (flat - diffuse);
        self.base() * shape * lambertian::VALUE
    }

    /// The albedo of the base times its share.
    #[must_use]
    pub fn base(&self) -> f64 {
        (1.0 - self.metallic) * (1.0 - self.transmission) * self.color
    }

    /// The same point as seen from the back.
    #[must_use]
    pub fn inside(&self) -> PrincipledInside {
        PrincipledInside {
            interface: RoughDielectric {
                facets: self.facets,
                index: 1.0 / self.index,
            },
            strength: self.through(),
            tint: self.tint_through(),
        }
    }

    /// The share of the transmitting interface.
    fn through(&self) -> f64 {
        (1.0 - self.metallic) * self.transmission
    }

    /// The factor on transmitted light, whose square is the colour: light usually passes
    /// two surfaces of an object.
    fn tint_through(&self) -> f64 {
        self.color.max(0.0).sqrt()
    }

    /// The interface as seen from the front.
    fn interface(&self) -> RoughDielectric {
        RoughDielectric {
            facets: self.facets,
            index: self.index,
        }
    }

    /// The reflectance of the facets at an angle of this cosine. Schlick's approximation
    /// describes the metal, and Fresnel's equations the dielectric.
    fn reflected(&self, cosine: f64) -> f64 {
        let dielectric = Interface::new(self.index, cosine).reflected;
        let normal = (self.index - 1.0) / (self.index + 1.0);
        let tinted = raised(normal * normal, cosine);
        self.metallic * raised(self.color, cosine)
            + (1.0 - self.metallic) * (dielectric + self.tint * (tinted - dielectric))
    }

    /// The BRDF of the clear coat, with the distribution GTR1 (Burley 2012, section 5.4).
    fn coat_value(&self, wi: DVec3, wo: DVec3) -> f64 {
        /// The roughness of Smith's masking, whatever the roughness of the distribution is.
        const MASKING: f64 = 0.25;
        let normal = (wi + wo).normalize();
        let facets = Microfacets::isotropic(MicrofacetDistribution::Ggx, MASKING);
        let masking = facets.g1(wi) * facets.g1(wo);
        0.25 * self.clearcoat * raised(0.04, normal.dot(wo)) * self.coat_d(normal) * masking
    }

    /// D of the clear coat's normals, per steradian.
    fn coat_d(&self, normal: DVec3) -> f64 {
        let squared = self.coat_alpha * self.coat_alpha;
        let less = squared - 1.0;
        less / (PI * libm::log(squared) * (1.0 + less * normal.z * normal.z))
    }

    /// Samples the mirror direction of wo at a normal of the clear coat, in proportion to D cos θ.
    fn coat_sample(&self, wo: DVec3, [a, b]: [f64; 2]) -> DVec3 {
        let squared = self.coat_alpha * self.coat_alpha;
        let height = (1.0 - power(squared, 1.0 - b)) / (1.0 - squared);
        let (sin, cos) = sincos_turns(a);
        let radius = (1.0 - height).max(0.0).sqrt();
        let normal = DVec3::new(radius * cos, radius * sin, height.max(0.0).sqrt());
        mirrored(wo, normal)
    }

    fn coat_density(&self, wi: DVec3, wo: DVec3) -> f64 {
        let Some(normal) = (wi + wo).try_normalize() else {
            return 0.0;
        };
        self.coat_d(normal) * normal.z / (4.0 * normal.dot(wo))
    }

    /// The shares of directions that the facets, the clear coat and the transmitting
    /// interface sample: approximately their shares of the light.
    fn shares(&self, wo: DVec3) -> [f64; 3] {
        let facets = self.reflected(wo.z);
        let coat = 0.25 * self.clearcoat;
        let through = self.through() * self.tint_through();
        let all = facets + coat + through + self.base() + (1.0 - self.metallic) * self.sheen;
        if all <= 0.0 {
            return [0.5, 0.0, 0.0];
        }
        let facets = (facets / all).max(MIN_SHARE);
        let coat = (coat / all).min(1.0 - facets);
        [facets, coat, (through / all).min(1.0 - facets - coat)]
    }
}

impl Bsdf for Principled {
    fn value(&self, wi: DVec3, wo: DVec3) -> f64 {
        if wi.z <= 0.0 {
            return match self.through() {
                0.0 => 0.0,
                share => share * self.tint_through() * self.interface().value(wi, wo),
            };
        }
        let (value, cosine) = self.facets.value(wi, wo);
        let sheen = (1.0 - self.metallic) * self.sheen * schlick(cosine);
        let coat = match self.clearcoat {
            0.0 => 0.0,
            _ => self.coat_value(wi, wo),
        };
        value * self.reflected(cosine) + self.base_value(wi, wo) + sheen + coat
    }

    fn density(&self, wi: DVec3, wo: DVec3) -> f64 {
        let [facets, coat, through] = self.shares(wo);
        let of_interface = match through {
            0.0 => 0.0,
            _ => through * self.interface().density(wi, wo),
        };
        if wi.z <= 0.0 {
            return of_interface;
        }
        let of_coat = match coat {
            0.0 => 0.0,
            _ => coat * self.coat_density(wi, wo),
        };
        let rest = (1.0 - facets - coat - through).max(0.0);
        let of_facets = facets * self.facets.density(wi, wo);
        of_facets + of_coat + rest * lambertian::density(wi) + of_interface
    }

    fn direction(&self, wo: DVec3, [a, b, c]: [f64; 3]) -> Option<DVec3> {
        let [facets, coat, through] = self.shares(wo);
        let opaque = 1.0 - through;
        if c >= opaque {
            return self
                .interface()
                .direction(wo, [a, b, (c - opaque) / through]);
        }
        before(if c < facets {
            self.facets.sample(wo, [a, b])
        } else if c < facets + coat {
            self.coat_sample(wo, [a, b])
        } else {
            lambertian::sample([a, b])
        })
    }
}

/// The back of a [`Principled`]: only its transmitting interface. wo is in front of this side.
#[derive(Clone, Copy, Debug)]
pub struct PrincipledInside {
    interface: RoughDielectric,
    /// The share of the interface.
    strength: f64,
    /// The factor on transmitted light.
    tint: f64,
}

impl Bsdf for PrincipledInside {
    fn value(&self, wi: DVec3, wo: DVec3) -> f64 {
        let tint = if wi.z > 0.0 { 1.0 } else { self.tint };
        match self.strength {
            0.0 => 0.0,
            strength => strength * tint * self.interface.value(wi, wo),
        }
    }

    fn density(&self, wi: DVec3, wo: DVec3) -> f64 {
        match self.strength {
            0.0 => 0.0,
            _ => self.interface.density(wi, wo),
        }
    }

    fn direction(&self, wo: DVec3, random: [f64; 3]) -> Option<DVec3> {
        (self.strength > 0.0).then(|| self.interface.direction(wo, random))?
    }
}

/// Schlick's reflectance for a reflectance at normal incidence.
fn raised(normal: f64, cosine: f64) -> f64 {
    normal + (1.0 - normal) * schlick(cosine)
}

/// Returns (1 − cos)⁵, the weight in Schlick's approximation (Schlick 1994).
pub(crate) fn schlick(cosine: f64) -> f64 {
    let rest = (1.0 - cosine).clamp(0.0, 1.0);
    let squared = rest * rest;
    squared * squared * rest
}
