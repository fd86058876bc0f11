//! Microfacets with two roughnesses (Walter et al. 2007; along two axes: Heitz 2014, *Understanding the masking-shadowing function*).

use super::bounce::{Bounce, mirrored};
use super::fresnel::{Interface, dielectric};
use etendue_world::Distribution;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// A distribution of normals about Z.
#[derive(Clone, Copy, Debug)]
pub(super) struct Microfacets {
    pub(super) distribution: Distribution,
    /// α along X and Y.
    pub(super) alpha: [f64; 2],
}

impl Microfacets {
    /// D of a normal of unit length with z > 0.
    pub(super) fn normals(&self, normal: DVec3) -> f64 {
        let [a, b] = self.alpha;
        let spread = (normal.x / a).powi(2) + (normal.y / b).powi(2);
        let z2 = normal.z * normal.z;
        match self.distribution {
            Distribution::Beckmann => libm::exp(-spread / z2) / (PI * a * b * z2 * z2),
            Distribution::Ggx => ggx(spread, z2, a * b),
        }
    }

    /// Smith's G₁: the share of the normals facing a direction that it sees.
    pub(super) fn seen(&self, direction: DVec3) -> f64 {
        let slope = self.slope(direction);
        match self.distribution {
            Distribution::Beckmann => {
                let a = 1.0 / slope;
                // Nothing is left to subtract beyond: erfc(6) is below rounding.
                if a > 6.0 {
                    return 1.0;
                }
                2.0 / (1.0 + libm::erf(a) + libm::exp(-a * a) / (a * PI.sqrt()))
            }
            Distribution::Ggx => 2.0 / (1.0 + (1.0 + slope * slope).sqrt()),
        }
    }

    /// α tan θ along the azimuth of a direction.
    fn slope(&self, direction: DVec3) -> f64 {
        let across = libm::hypot(self.alpha[0] * direction.x, self.alpha[1] * direction.y);
        across / direction.z.abs()
    }

    /// A normal for light seen from `wo`, z > 0: by what is visible of GGX (Heitz 2018, *Sampling the GGX distribution of visible normals*, Listing 1).
    ///
    /// Beckmann's normals are drawn by it too: their density is at most 4/e of GGX's.
    pub(super) fn normal(&self, wo: DVec3, [a, b]: [f64; 2]) -> DVec3 {
        let stretch = DVec3::new(self.alpha[0], self.alpha[1], 1.0);
        let view = (stretch * wo).normalize();
        let across = DVec3::new(-view.y, view.x, 0.0).try_normalize();
        let across = across.unwrap_or(DVec3::X);
        let up = view.cross(across);
        let (sin, cos) = libm::sincos(TAU * b);
        let radius = a.sqrt();
        let t1 = radius * cos;
        let seen = 0.5 * (1.0 + view.z);
        let t2 = (1.0 - seen) * (1.0 - t1 * t1).max(0.0).sqrt() + seen * radius * sin;
        let t3 = (1.0 - t1 * t1 - t2 * t2).max(0.0).sqrt();
        let normal = t1 * across + t2 * up + t3 * view;
        // A normal at the horizon is kept just above it.
        (stretch * normal.with_z(normal.z.max(1e-12))).normalize()
    }

    /// The density of [`Self::normal`] per solid angle of normals.
    pub(super) fn normal_density(&self, wo: DVec3, normal: DVec3) -> f64 {
        let facing = wo.dot(normal);
        if normal.z <= 0.0 || facing <= 0.0 {
            return 0.0;
        }
        let [a, b] = self.alpha;
        let spread = (normal.x / a).powi(2) + (normal.y / b).powi(2);
        let slope = self.slope(wo);
        let seen = 2.0 / (1.0 + (1.0 + slope * slope).sqrt());
        seen * facing * ggx(spread, normal.z * normal.z, a * b) / wo.z
    }

    /// The BRDF of mirrors times the cosine of wi, both directions being in front (Walter et al. 2007, Eq. 20), without Fresnel factor.
    pub(super) fn reflected(&self, wi: DVec3, wo: DVec3) -> (f64, DVec3) {
        let normal = (wi + wo).normalize();
        let shadowing = self.seen(wi) * self.seen(wo);
        let value = self.normals(normal) * shadowing / (4.0 * wo.z);
        (value, normal)
    }

    /// The density of mirroring wo at [`Self::normal`].
    pub(super) fn reflected_density(&self, wi: DVec3, wo: DVec3) -> f64 {
        let Some(normal) = (wi + wo).try_normalize() else {
            return 0.0;
        };
        self.normal_density(wo, normal) / (4.0 * wo.dot(normal))
    }

    /// A direction that wo is mirrored to.
    pub(super) fn reflect(&self, wo: DVec3, random: [f64; 2]) -> DVec3 {
        mirrored(wo, self.normal(wo, random))
    }
}

fn ggx(spread: f64, z2: f64, area: f64) -> f64 {
    1.0 / (PI * area * (spread + z2).powi(2))
}

/// A rough interface (Walter et al. 2007, section 4). `index` is that of the far side over that of the side of wo, which has z > 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct RoughInterface {
    pub(super) facets: Microfacets,
    pub(super) index: f64,
}

impl RoughInterface {
    /// The normal at which wo is mirrored or refracted to wi; `None` if there is none that faces the front.
    fn normal(&self, wi: DVec3, wo: DVec3) -> Option<DVec3> {
        let eta = if wi.z > 0.0 { 1.0 } else { self.index };
        let normal = (wo + eta * wi).try_normalize()?;
        let normal = if normal.z < 0.0 { -normal } else { normal };
        // Both must see it from their own side.
        let sound = wo.dot(normal) > 0.0 && wi.dot(normal) * wi.z > 0.0;
        sound.then_some(normal)
    }

    /// BSDF times |cos| of wi, as it carries radiance; the share that is reflected at the normal.
    pub(super) fn value(&self, wi: DVec3, wo: DVec3) -> f64 {
        let Some(normal) = self.normal(wi, wo) else {
            return 0.0;
        };
        let (i, o) = (wi.dot(normal), wo.dot(normal));
        let Interface { reflected, .. } = dielectric(self.index, o);
        let common = self.facets.normals(normal) * self.facets.seen(wi) * self.facets.seen(wo);
        if wi.z > 0.0 {
            return reflected * common / (4.0 * wo.z);
        }
        let sum = o + self.index * i;
        // Radiance is that of the far side over the squared index, and solid angles there are smaller by as much.
        (1.0 - reflected) * common * (o * i).abs() / (wo.z * sum * sum)
    }

    /// The density of [`Self::sample`].
    pub(super) fn density(&self, wi: DVec3, wo: DVec3) -> f64 {
        let Some(normal) = self.normal(wi, wo) else {
            return 0.0;
        };
        let (i, o) = (wi.dot(normal), wo.dot(normal));
        let Interface { reflected, .. } = dielectric(self.index, o);
        let of_normal = self.facets.normal_density(wo, normal);
        if wi.z > 0.0 {
            return reflected * of_normal / (4.0 * o);
        }
        let sum = o + self.index * i;
        (1.0 - reflected) * of_normal * self.index * self.index * i.abs() / (sum * sum)
    }

    /// Mirrors or refracts wo at a normal, each as often as light does.
    pub(super) fn sample(&self, wo: DVec3, [a, b, c]: [f64; 3]) -> Option<Bounce> {
        let normal = self.facets.normal(wo, [a, b]);
        let at = dielectric(self.index, wo.dot(normal));
        let wi = if c < at.reflected {
            mirrored(wo, normal)
        } else {
            at.refracted(wo, normal)
        };
        let density = self.density(wi, wo);
        let is_reflected = c < at.reflected;
        // Reflected below the front or refracted above it: such paths carry nothing.
        if (wi.z > 0.0) != is_reflected || density <= 0.0 {
            return None;
        }
        let weight = self.value(wi, wo) / density;
        Some(Bounce {
            wi,
            weight,
            density: Some(density),
        })
    }
}
