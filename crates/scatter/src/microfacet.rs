//! Microfacets with a roughness along each of two axes (Walter, Marschner, Li, Torrance 2007, *Microfacet models for refraction through rough surfaces*;
//! along two axes: Heitz 2014, *Understanding the masking-shadowing function in microfacet-based BRDFs*).

use crate::bsdf::mirrored;
use etendue_field::{MicrofacetDistribution, sincos_turns};
use glam::DVec3;
use std::f64::consts::PI;

/// Microfacets that are mirrors. Their normals are distributed about Z, and they mask each other by
/// Smith's function.
#[derive(Clone, Copy, Debug)]
pub struct Microfacets {
    /// The distribution of the normals.
    pub distribution: MicrofacetDistribution,
    /// α along X and Y, above 0; equal for an isotropic surface.
    pub alpha: [f64; 2],
}

/// The smallest z of a visible normal before stretching. This minimum keeps normals above the
/// horizon.
const MIN_HEIGHT: f64 = 1e-12;

impl Microfacets {
    /// Returns microfacets with the same roughness along both axes.
    #[inline]
    #[must_use]
    pub fn isotropic(distribution: MicrofacetDistribution, roughness: f64) -> Self {
        Self {
            distribution,
            alpha: [roughness; 2],
        }
    }

    /// The BRDF of perfect mirrors, for two directions in front of the surface (Walter et
    /// al., Eq. 20). Also returns the cosine of the angle of incidence on the mirrors, for a
    /// Fresnel factor.
    #[inline]
    #[must_use]
    pub fn value(&self, wi: DVec3, wo: DVec3) -> (f64, f64) {
        let normal = (wi + wo).normalize();
        let masking = self.g1(wi) * self.g1(wo);
        let value = self.d(normal) * masking / (4.0 * wi.z * wo.z);
        (value, normal.dot(wo).min(1.0))
    }

    /// Samples the mirror direction of wo at a normal that is visible from wo. Near grazing incidence, some sampled
    /// directions lie below the surface.
    #[inline]
    #[must_use]
    pub fn sample(&self, wo: DVec3, random: [f64; 2]) -> DVec3 {
        mirrored(wo, self.sample_normal(wo, random))
    }

    /// The density of [`Self::sample`], over the whole sphere. The density of directions is the density of
    /// the normal, divided by 4 h · ωo (Walter et al., Eq. 14).
    #[inline]
    #[must_use]
    pub fn density(&self, wi: DVec3, wo: DVec3) -> f64 {
        match (wi + wo).try_normalize() {
            Some(normal) if normal.z > 0.0 => {
                ggx_g1(self.slope(wo)) * self.ggx_d(normal) / (4.0 * wo.z)
            }
            _ => 0.0,
        }
    }

    /// Samples the mirror direction of wo at any normal, visible from wo or not, in proportion to D
    /// cos θ (Walter et al., Eqs. 28 f. and 35 f.).
    ///
    /// Near normal incidence, for Beckmann's distribution, weights are closer to 1 than the weights
    /// of [`Self::sample`]. Towards grazing incidence, they grow without bound.
    #[inline]
    #[must_use]
    pub fn sample_unmasked(&self, wo: DVec3, [a, b]: [f64; 2]) -> DVec3 {
        let tangent = match self.distribution {
            MicrofacetDistribution::Beckmann => (-libm::log(a)).sqrt(),
            MicrofacetDistribution::Ggx => (a / (1.0 - a)).sqrt(),
        };
        let (sin, cos) = sincos_turns(b);
        let [x, y] = self.alpha.map(|alpha| alpha * tangent);
        mirrored(wo, DVec3::new(x * cos, y * sin, 1.0).normalize())
    }

    /// The density of [`Self::sample_unmasked`], over the whole sphere. A normal that is
    /// seen from behind reflects like its opposite.
    #[inline]
    #[must_use]
    pub fn unmasked_density(&self, wi: DVec3, wo: DVec3) -> f64 {
        let normal = (wi + wo).try_normalize();
        normal.map_or(0.0, |normal| {
            self.d(normal) * normal.z.abs() / (4.0 * normal.dot(wo))
        })
    }

    /// D, per steradian, of a normal of unit length of either sign (Walter et al., Eqs. 25
    /// and 33, with slopes divided by α along each axis).
    #[inline]
    pub(crate) fn d(&self, normal: DVec3) -> f64 {
        match self.distribution {
            MicrofacetDistribution::Beckmann => {
                let squared = normal.z * normal.z;
                let area = self.alpha[0] * self.alpha[1];
                libm::exp(-self.spread(normal) / squared) / (PI * area * squared * squared)
            }
            MicrofacetDistribution::Ggx => self.ggx_d(normal),
        }
    }

    /// Smith's G₁: among the normals that face a direction, the share of normals that are visible from this
    /// direction (Walter et al., Eqs. 26 f. and 34).
    #[inline]
    pub(crate) fn g1(&self, direction: DVec3) -> f64 {
        let slope = self.slope(direction);
        match self.distribution {
            MicrofacetDistribution::Beckmann => {
                let a = 1.0 / slope;
                // For larger arguments, erfc is less than erfc(6), which is smaller than the
                // rounding error.
                if a > 6.0 {
                    return 1.0;
                }
                2.0 / (1.0 + libm::erf(a) + libm::exp(-a * a) / (a * PI.sqrt()))
            }
            MicrofacetDistribution::Ggx => ggx_g1(slope),
        }
    }

    /// Samples a normal with z > 0 that is visible from wo, for GGX (Heitz 2018, *Sampling the GGX
    /// distribution of visible normals*, Listing 1).
    ///
    /// Beckmann's normals are sampled in the same way: D is at most 4/e times the D of GGX, and G₁ is at most √π
    /// times the G₁ of GGX.
    #[inline]
    pub(crate) fn sample_normal(&self, wo: DVec3, [a, b]: [f64; 2]) -> DVec3 {
        // The direction is transformed to the space in which the ellipsoid of normals is a
        // hemisphere.
        let stretch = DVec3::new(self.alpha[0], self.alpha[1], 1.0);
        let view = (stretch * wo).normalize();
        let across = DVec3::new(-view.y, view.x, 0.0).try_normalize();
        let across = across.unwrap_or(DVec3::X);
        let up = view.cross(across);
        // A point of the projected hemisphere is sampled. The projection consists of half of a
        // disc, and of the visible part of the other half.
        let (sin, cos) = sincos_turns(b);
        let radius = a.sqrt();
        let t1 = radius * cos;
        let seen = 0.5 * (1.0 + view.z);
        let t2 = (1.0 - seen) * (1.0 - t1 * t1).max(0.0).sqrt() + seen * radius * sin;
        let t3 = (1.0 - t1 * t1 - t2 * t2).max(0.0).sqrt();
        let normal = t1 * across + t2 * up + t3 * view;
        (stretch * normal.with_z(normal.z.max(MIN_HEIGHT))).normalize()
    }

    /// The density of [`Self::sample_normal`] per solid angle of normals: D G₁ ωo · n / cos
    /// θo of GGX (Heitz 2018).
    #[inline]
    pub(crate) fn normal_density(&self, wo: DVec3, normal: DVec3) -> f64 {
        let facing = wo.dot(normal);
        if normal.z <= 0.0 || facing <= 0.0 {
            return 0.0;
        }
        ggx_g1(self.slope(wo)) * facing * self.ggx_d(normal) / wo.z
    }

    /// D of GGX with these roughnesses.
    #[inline]
    fn ggx_d(&self, normal: DVec3) -> f64 {
        let sum = self.spread(normal) + normal.z * normal.z;
        1.0 / (PI * self.alpha[0] * self.alpha[1] * sum * sum)
    }

    /// Returns (x/αx)² + (y/αy)². Unlike 1 − z², this expression keeps its digits for normals close
    /// to Z.
    #[inline]
    fn spread(&self, normal: DVec3) -> f64 {
        let [x, y] = [normal.x / self.alpha[0], normal.y / self.alpha[1]];
        x * x + y * y
    }

    /// Returns α tan θ along the azimuth of a direction (Heitz 2014).
    #[inline]
    fn slope(&self, direction: DVec3) -> f64 {
        let [x, y] = [self.alpha[0] * direction.x, self.alpha[1] * direction.y];
        (x * x + y * y).sqrt() / direction.z.abs()
    }
}

/// G₁ of GGX for a direction with this α tan θ.
#[inline]
fn ggx_g1(slope: f64) -> f64 {
    2.0 / (1.0 + (1.0 + slope * slope).sqrt())
}
