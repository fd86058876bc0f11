//! Phong's lobe: a power of the cosine of the angle to the mirror direction.

use crate::bsdf::before;
use crate::{Bsdf, lambertian};
use etendue_field::{power, sincos_turns};
use etendue_sampling::about;
use glam::DVec3;
use std::f64::consts::TAU;

/// Phong's lobe (Phong 1975) with integral 1 over all directions of wi.
#[derive(Clone, Copy, Debug)]
pub struct Phong {
    /// Exponent n, at least 0.
    pub exponent: f64,
}

impl Phong {
    /// Returns (n + 1)/(2π) cosⁿ α, where α is the angle between wi and the mirror direction of wo.
    /// The value is 0 if α is 90° or more, even for n = 0.
    #[inline]
    #[must_use]
    pub fn value(&self, wi: DVec3, wo: DVec3) -> f64 {
        let cosine = mirror_direction(wo).dot(wi).min(1.0);
        if cosine <= 0.0 {
            return 0.0;
        }
        (self.exponent + 1.0) / TAU * power(cosine, self.exponent)
    }

    /// Samples a direction by the lobe. Near grazing incidence, some sampled directions lie below the surface.
    #[inline]
    #[must_use]
    pub fn sample(&self, wo: DVec3, [a, b]: [f64; 2]) -> DVec3 {
        let (sin, cos) = sincos_turns(b);
        let along = power(a, 1.0 / (self.exponent + 1.0));
        let across = ((1.0 - along) * (1.0 + along)).sqrt();
        let local = DVec3::new(across * cos, across * sin, along);
        about(mirror_direction(wo), local)
    }
}

#[inline]
fn mirror_direction(wo: DVec3) -> DVec3 {
    DVec3::new(-wo.x, -wo.y, wo.z)
}

/// The modified Phong BRDF: kd / π + ks (n + 2)/(2π) cosⁿ α (Lafortune and Willems 1994, *Using the modified Phong reflectance model for physically
/// based rendering*).
#[derive(Clone, Copy, Debug)]
pub struct ModifiedPhong {
    /// Diffuse factor kd.
    pub diffuse: f64,
    /// Specular factor ks.
    pub specular: f64,
    /// The lobe, with its exponent n.
    pub lobe: Phong,
}

impl ModifiedPhong {
    /// The share of directions that are sampled by the lobe, ks / (kd + ks). The other directions are sampled
    /// in proportion to the cosine.
    #[inline]
    fn specular_share(&self) -> f64 {
        let sum = self.diffuse + self.specular;
        if sum > 0.0 { self.specular / sum } else { 0.5 }
    }
}

impl Bsdf for ModifiedPhong {
    #[inline]
    fn value(&self, wi: DVec3, wo: DVec3) -> f64 {
        if wi.z <= 0.0 {
            return 0.0;
        }
        let n = self.lobe.exponent;
        let lobe = (n + 2.0) / (n + 1.0) * self.lobe.value(wi, wo);
        self.diffuse * lambertian::VALUE + self.specular * lobe
    }

    #[inline]
    fn density(&self, wi: DVec3, wo: DVec3) -> f64 {
        if wi.z <= 0.0 {
            return 0.0;
        }
        let share = self.specular_share();
        share * self.lobe.value(wi, wo) + (1.0 - share) * lambertian::density(wi)
    }

    #[inline]
    fn direction(&self, wo: DVec3, [a, b, c]: [f64; 3]) -> Option<DVec3> {
        before(if c < self.specular_share() {
            self.lobe.sample(wo, [a, b])
        } else {
            lambertian::sample([a, b])
        })
    }
}
