//! What a light emits.

use super::System;
use crate::chain::no_closed_form;
use crate::shadow::is_rectangular;
use etendue_field::{Light, Mask, Shape};
use std::f64::consts::TAU;

/// What the light's rays are counted by: two of the coordinates x, y, u, v, and for an area light the other two as well.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Emission {
    /// Indices of the two coordinates that the inner rule of a quadrature covers.
    pub(super) inner: [usize; 2],
    /// The light whose points the outer rule covers.
    pub(super) shape: Option<Shape>,
    /// Where to stop looking for rays, in the inner coordinates.
    pub(super) reach: [f64; 2],
    /// Cycles per unit of the inner coordinates in the light's picture.
    pub(super) cycles: [f64; 2],
}

/// Half-width of a Gaussian picture, in its widths: exp(−π 3.6²) = 2·10⁻¹⁸.
const GAUSSIAN: f64 = 3.6;
/// Slopes beyond which no ray is looked for, where the light has no picture.
const STEEPEST: f64 = 30.0;

impl System {
    pub(super) fn emission(&self) -> Emission {
        let (inner, image, shape) = match self.light {
            Light::Projector { image, .. } => ([2, 3], Some(image), None),
            Light::Point { .. } => ([2, 3], None, None),
            Light::Beam { image, .. } => ([0, 1], Some(image), None),
            Light::Area { shape, .. } => ([2, 3], None, Some(shape)),
            Light::Environment { .. } => no_closed_form(),
        };
        let mut cycles = [0.0; 2];
        if let Some(image) = image {
            // The transform of a Gaussian of width w is below 10⁻⁵ from 2/w on.
            cycles = image.width.map(|w| 2.0 / w);
            if let Some(grating) = image.grating {
                cycles[grating.axis] += grating.frequency.abs();
            }
        }
        for (distance, mask) in &self.layers {
            if let Mask::Grating(grating) = mask {
                let per_unit = if inner[0] == 0 { 1.0 } else { *distance };
                cycles[grating.axis] += grating.frequency.abs() * per_unit;
            }
        }
        Emission {
            inner,
            shape,
            reach: image.map_or([STEEPEST; 2], |image| image.width.map(|w| GAUSSIAN * w)),
            cycles,
        }
    }

    /// The system without those opaque masks that can be taken apart into rectangles, and these masks.
    pub(super) fn apart(&self) -> (Self, Vec<(f64, Mask)>) {
        let goes = |mask: &Mask| matches!(mask, Mask::Opaque { .. }) && is_rectangular(mask);
        let layers = self.layers.iter().cloned();
        let (opaque, layers) = layers.partition(|(_, mask)| goes(mask));
        let left = Self {
            layers,
            ..self.clone()
        };
        (left, opaque)
    }

    /// Flux per unit of the emission's coordinates of the ray (x, y, u, v), masks included.
    pub(super) fn flux(&self, ray: [f64; 4]) -> f64 {
        let [x, y, u, v] = ray;
        let cosine = 1.0 / (1.0 + u * u + v * v).sqrt();
        let emitted = match self.light {
            Light::Projector { intensity, image } => intensity * image.value(u, v) * cosine.powi(3),
            Light::Point { intensity } => intensity * cosine.powi(3),
            Light::Beam { irradiance, image } => irradiance * image.value(x, y),
            Light::Area {
                radiance, exponent, ..
            } => radiance * cosine.powi(4) * cosine.powf(exponent),
            Light::Environment { .. } => no_closed_form(),
        };
        emitted * passed(&self.layers, ray)
    }
}

/// The share of a ray of the light's plane that passes masks.
pub(super) fn passed(masks: &[(f64, Mask)], [x, y, u, v]: [f64; 4]) -> f64 {
    let each = masks.iter();
    each.map(|(distance, mask)| transmittance(mask, x + distance * u, y + distance * v))
        .product()
}

fn transmittance(mask: &Mask, x: f64, y: f64) -> f64 {
    match mask {
        Mask::Opaque {
            shapes,
            half_planes,
        } => {
            let stopped = shapes.iter().any(|s| s.contains(x, y))
                || half_planes.iter().any(|h| h.contains(x, y));
            f64::from(u8::from(!stopped))
        }
        Mask::Grating(grating) => grating.transmittance(x, y),
    }
}

/// The point of a shape at (a, b) of the unit square; equal areas of one are equal shares of the other.
pub(super) fn point_of(shape: &Shape, [a, b]: [f64; 2]) -> [f64; 2] {
    match shape {
        Shape::Rectangle(rectangle) => {
            let [x, y] = rectangle.center;
            let [w, h] = rectangle.size;
            [x + w * (a - 0.5), y + h * (b - 0.5)]
        }
        Shape::Disc(disc) => {
            let [x, y] = disc.center;
            let (sin, cos) = (TAU * b).sin_cos();
            let r = disc.radius * a.sqrt();
            [x + r * cos, y + r * sin]
        }
    }
}
