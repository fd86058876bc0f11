//! Lambert's BRDF on both sides, with a part of the light transmitted diffusely.

use crate::{Bsdf, lambertian};
use glam::DVec3;

/// A surface that reflects and transmits light diffusely. wo is in front of the surface.
#[derive(Clone, Copy, Debug)]
pub struct DiffuseTransmission {
    /// The share of light that is reflected.
    pub reflectance: f64,
    /// The share of light that is transmitted.
    pub transmittance: f64,
}

impl DiffuseTransmission {
    /// The share of directions that are sampled in front of the surface.
    fn share(&self) -> f64 {
        let sum = self.reflectance + self.transmittance;
        if sum > 0.0 {
            self.reflectance / sum
        } else {
            0.5
        }
    }
}

impl Bsdf for DiffuseTransmission {
    fn value(&self, wi: DVec3, _wo: DVec3) -> f64 {
        let part = match wi.z > 0.0 {
            true => self.reflectance,
            false => self.transmittance,
        };
        part * lambertian::VALUE
    }

    fn density(&self, wi: DVec3, _wo: DVec3) -> f64 {
        let part = match wi.z > 0.0 {
            true => self.share(),
            false => 1.0 - self.share(),
        };
        part * lambertian::density(wi.abs())
    }

    fn direction(&self, _wo: DVec3, [a, b, c]: [f64; 3]) -> Option<DVec3> {
        let wi = lambertian::sample([a, b]);
        Some(if c < self.share() { wi } else { -wi })
    }
}
