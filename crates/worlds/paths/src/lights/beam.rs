//! Point lights whose intensity depends on the direction: spots and projectors.

use etendue_world::Light;
use glam::{DAffine3, DVec3};

/// A spot or a projector.
#[derive(Debug)]
pub(super) struct Beam {
    pub(super) to_local: DAffine3,
    /// Cosine of the half-angle of a cone around Z that contains all light.
    pub(super) cosine: f64,
    /// The spot or projector, which states the intensity by direction.
    pub(super) light: Light,
}

impl Beam {
    /// The intensity along a direction in world coordinates, W sr⁻¹.
    pub(super) fn intensity(&self, along: DVec3) -> f64 {
        let local = self.to_local.transform_vector3(along);
        match &self.light {
            Light::Spot {
                intensity,
                beam,
                cutoff,
                falloff,
                picture,
                ..
            } => {
                let angle = libm::atan2(local.truncate().length(), local.z);
                let plain = intensity * falloff.share(angle, *beam, *cutoff);
                match picture {
                    Some(picture) if plain > 0.0 => {
                        let at = local.truncate() / (local.z * libm::tan(*cutoff));
                        plain * picture.value(&(0.5 + 0.5 * at).into())
                    }
                    _ => plain,
                }
            }
            Light::Projector {
                half,
                picture,
                scale,
                ..
            } => {
                let at = local.truncate() / (local.z * *half);
                if local.z <= 0.0 || at.abs().max_element() > 1.0 {
                    return 0.0;
                }
                let secant = local.length() / local.z;
                scale * picture.value(&(0.5 - 0.5 * at).into()) * secant * secant * secant
            }
            // No other light is made a beam.
            Light::Point { .. }
            | Light::Directional { .. }
            | Light::Sheet { .. }
            | Light::Constant { .. }
            | Light::Sky(_) => 0.0,
        }
    }
}
