//! The light that is incident on a point of a surface from one part of a light.

use crate::light::{LightPart, emitted};
use crate::obstacle::LegRay;
use crate::path::PreparedPath;
use glam::DVec3;

/// Light that arrives with slopes (u, v).
#[derive(Clone, Copy, Debug)]
pub(super) struct IncomingLight {
    pub(super) slopes: [f64; 2],
    /// Radiance times du dv per unit of the part's measure. If the part is [`LightPart::Whole`],
    /// the weight is the product of radiance and du dv.
    pub(super) weight: f64,
}

impl PreparedPath<'_> {
    /// The light that a point receives from a part of the light; the point is in the frame
    /// at the light. `passes` gives the fraction of a ray that arrives, for the ray and its length.
    pub(super) fn incoming(
        &self,
        point: DVec3,
        part: LightPart,
        passes: impl FnOnce(&LegRay, f64) -> f64,
    ) -> IncomingLight {
        let light = &self.system.light;
        let DVec3 { x, y, z } = point;
        // The point where the ray leaves the light's plane, and its slopes.
        let ([a, b], [u, v]) = match part {
            LightPart::Sky { slopes, .. } => ([0.0; 2], slopes),
            LightPart::Whole if light.is_distant() => ([x, y], [0.0; 2]),
            LightPart::Whole => ([0.0; 2], [x / z, y / z]),
            LightPart::Point([a, b]) => ([a, b], [(x - a) / z, (y - b) / z]),
        };
        let slopes = [u, v];
        let weight = match part {
            // du dv = dω / cos³.
            LightPart::Sky { radiance, .. } => radiance * secant(slopes).powi(3),
            LightPart::Whole if light.is_distant() => emitted(light, [a, b, u, v]),
            // Flux per du dv is converted to radiance, with du dv = dx dy / z².
            _ => emitted(light, [a, b, u, v]) * secant(slopes).powi(4) / (z * z),
        };
        // All light starts in the plane z = 0, including light from an environment.
        let passes = if weight > 0.0 && z > 0.0 {
            let along = DVec3::new(u, v, 1.0);
            let ray = LegRay {
                point: point - along * z,
                direction: along.normalize(),
            };
            passes(&ray, z * along.length())
        } else {
            0.0
        };
        IncomingLight {
            slopes,
            weight: weight * passes,
        }
    }
}

/// Returns 1/cos of the angle between the central ray and a ray with slopes (u, v).
pub(super) fn secant([u, v]: [f64; 2]) -> f64 {
    (1.0 + u * u + v * v).sqrt()
}
