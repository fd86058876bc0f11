//! What shines on a point from one part of the light.

use crate::mask::Masks;
use etendue_field::Light;
use glam::DVec3;

/// A part of the light that is drawn.
#[derive(Clone, Copy, Debug)]
pub(super) enum Part {
    /// All of it: a point of the surface sees it from one direction alone.
    Whole,
    /// A point of an area light. Densities of such are per square metre.
    Point([f64; 2]),
    /// A direction of an environment, as the slopes of its rays, and the radiance from there.
    /// Densities of such are per steradian.
    Sky {
        /// Forward.
        slopes: [f64; 2],
        /// W m⁻² sr⁻¹.
        radiance: f64,
    },
}

/// Light that arrives with slopes (u, v).
#[derive(Clone, Copy, Debug)]
pub(super) struct Incoming {
    pub(super) slopes: [f64; 2],
    /// Radiance times du dv per unit of the part's measure; of the whole light, their product.
    pub(super) weight: f64,
}

impl Masks<'_> {
    /// What a part of a light shines on a point in the frame at the light.
    pub(super) fn incoming(&self, light: &Light, point: DVec3, part: Part) -> Incoming {
        let DVec3 { x, y, z } = point;
        let (slopes, weight) = match (light, part) {
            (
                Light::Area {
                    shape,
                    radiance,
                    exponent,
                },
                Part::Point([a, b]),
            ) if shape.contains(a, b) => {
                let slopes = [(x - a) / z, (y - b) / z];
                let emitted = radiance * secant(slopes).powf(-exponent);
                (slopes, emitted / (z * z))
            }
            // du dv = dω / cos³.
            (Light::Environment { .. }, Part::Sky { slopes, radiance }) => {
                (slopes, radiance * secant(slopes).powi(3))
            }
            (Light::Point { intensity }, _) => {
                let slopes = [x / z, y / z];
                (slopes, intensity * secant(slopes) / (z * z))
            }
            (Light::Projector { intensity, image }, _) => {
                let slopes = [x / z, y / z];
                let seen = image.value(slopes[0], slopes[1]);
                (slopes, intensity * seen * secant(slopes) / (z * z))
            }
            (Light::Beam { irradiance, image }, _) => ([0.0; 2], irradiance * image.value(x, y)),
            (Light::Area { .. } | Light::Environment { .. }, _) => ([0.0; 2], 0.0),
        };
        // Light begins in its plane, also that from far away.
        let passes = if weight > 0.0 && z > 0.0 {
            self.transmittance(point, slopes)
        } else {
            0.0
        };
        Incoming {
            slopes,
            weight: weight * passes,
        }
    }
}

/// 1/cos of the angle to the central ray.
pub(super) fn secant([u, v]: [f64; 2]) -> f64 {
    (1.0 + u * u + v * v).sqrt()
}
