//! Distant light.

use etendue_sampling::{Cone, LatLongSampler, sphere};
use etendue_world::SkyMap;
use glam::{DMat3, DVec3};

/// Distant light, sampled by its radiance.
#[derive(Debug)]
pub(super) enum SampledSky {
    Constant(f64),
    Map {
        sampler: Box<LatLongSampler>,
        to_world: DMat3,
        to_map: DMat3,
    },
}

impl SampledSky {
    pub(super) fn new(map: &SkyMap) -> Self {
        Self::Map {
            sampler: Box::new(LatLongSampler::new(&map.radiance)),
            to_world: map.to_world,
            to_map: map.to_world.inverse(),
        }
    }

    /// Samples a direction towards the light.
    pub(super) fn sample(&self, r: [f64; 4]) -> DVec3 {
        match self {
            Self::Constant(_) => sphere([r[0], r[1]]),
            Self::Map {
                sampler, to_world, ..
            } => *to_world * sampler.sample(r),
        }
    }

    /// The radiance from a direction, and the density of [`Self::sample`].
    pub(super) fn radiance_and_density(&self, toward: DVec3) -> (f64, f64) {
        match self {
            Self::Constant(radiance) => (*radiance, 1.0 / Cone::SPHERE.solid_angle()),
            Self::Map {
                sampler, to_map, ..
            } => sampler.radiance_and_density(*to_map * toward),
        }
    }
}
