//! Microfacets (Walter, Marschner, Li, Torrance 2007, *Microfacet models for refraction through rough surfaces*).

use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// A surface of small mirrors with Smith's shadowing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Microfacets {
    pub(super) distribution: Distribution,
    pub(super) roughness: f64,
}

/// How their normals are distributed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Distribution {
    Beckmann,
    Ggx,
}

impl Microfacets {
    /// The BRDF without its Fresnel factor, both directions being in front of the surface (their Eq. 20).
    #[inline]
    pub(super) fn value(&self, wi: DVec3, wo: DVec3) -> f64 {
        let half = (wi + wo).normalize();
        let shadowing = self.shadowing(wi.z) * self.shadowing(wo.z);
        self.normals(half.z) * shadowing / (4.0 * wi.z * wo.z)
    }

    /// A normal, and the mirror direction to it: for Beckmann by D · cos θ, for GGX by what is visible.
    #[inline]
    pub(super) fn sample(&self, wi: DVec3, random: [f64; 2]) -> DVec3 {
        let normal = match self.distribution {
            Distribution::Beckmann => self.normal(random),
            Distribution::Ggx => self.visible_normal(wi, random),
        };
        2.0 * wi.dot(normal) * normal - wi
    }

    /// Solid angles of directions are 4 h · ωo times those of normals (their Eq. 14).
    #[inline]
    pub(super) fn density(&self, wi: DVec3, wo: DVec3) -> f64 {
        let sum = wi + wo;
        let Some(half) = sum.try_normalize() else {
            return 0.0;
        };
        let cosine = half.dot(wi);
        match self.distribution {
            // A normal seen from behind mirrors as its opposite does.
            Distribution::Beckmann => {
                let height = half.z.abs();
                self.normals(height) * height / (4.0 * cosine)
            }
            // G₁ h·ωi D / cos θi, over 4 h·ωi.
            Distribution::Ggx if half.z > 0.0 => {
                self.shadowing(wi.z) * self.normals(half.z) / (4.0 * wi.z)
            }
            Distribution::Ggx => 0.0,
        }
    }

    /// D of a normal at an angle with this cosine (their Eqs. 25 and 33).
    #[inline]
    fn normals(&self, cosine: f64) -> f64 {
        let a2 = self.roughness * self.roughness;
        let c2 = cosine * cosine;
        let tangent2 = (1.0 - c2).max(0.0) / c2;
        match self.distribution {
            Distribution::Beckmann => libm::exp(-tangent2 / a2) / (PI * a2 * c2 * c2),
            Distribution::Ggx => {
                let spread = c2 * (a2 + tangent2);
                a2 / (PI * spread * spread)
            }
        }
    }

    /// G₁ of a direction at an angle with this cosine: the share of what faces it that is seen (their Eqs. 26 f. and 34).
    #[inline]
    fn shadowing(&self, cosine: f64) -> f64 {
        let tangent = (1.0 - cosine * cosine).max(0.0).sqrt() / cosine;
        let slope = self.roughness * tangent;
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

    /// Beckmann's normals by D · cos θ (their Eqs. 28 f.).
    fn normal(&self, [a, b]: [f64; 2]) -> DVec3 {
        let tangent = self.roughness * (-libm::log(a)).sqrt();
        let (sin, cos) = libm::sincos(TAU * b);
        let height = 1.0 / (1.0 + tangent * tangent).sqrt();
        DVec3::new(height * tangent * cos, height * tangent * sin, height)
    }

    /// GGX's visible normals (Heitz 2018, *Sampling the GGX distribution of visible normals*, Listing 1).
    fn visible_normal(&self, wi: DVec3, [a, b]: [f64; 2]) -> DVec3 {
        let alpha = self.roughness;
        // To the hemisphere that the ellipsoid of normals is stretched from.
        let view = DVec3::new(alpha * wi.x, alpha * wi.y, wi.z).normalize();
        let across = DVec3::new(-view.y, view.x, 0.0).try_normalize();
        let across = across.unwrap_or(DVec3::X);
        let up = view.cross(across);
        // A point of the projected hemisphere: half of a disc, and what is seen of the other half.
        let (sin, cos) = libm::sincos(TAU * b);
        let radius = a.sqrt();
        let t1 = radius * cos;
        let seen = 0.5 * (1.0 + view.z);
        let t2 = (1.0 - seen) * (1.0 - t1 * t1).max(0.0).sqrt() + seen * radius * sin;
        let t3 = (1.0 - t1 * t1 - t2 * t2).max(0.0).sqrt();
        let normal = t1 * across + t2 * up + t3 * view;
        DVec3::new(alpha * normal.x, alpha * normal.y, normal.z.max(0.0)).normalize()
    }
}
