//! Masks across the central ray.

use crate::{Grating, HalfPlane, Hole, Shape};
use serde::Serialize;

/// A mask that multiplies radiance, in one plane across the central ray.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Mask {
    /// Opaque, black shapes that do not overlap.
    Opaque {
        /// Bounded shapes.
        shapes: Vec<Shape>,
        /// Half-planes.
        half_planes: Vec<HalfPlane>,
    },
    /// A grating over the whole plane.
    Grating(Grating),
    /// An opaque, black screen over the whole plane with one hole.
    Aperture(Hole),
}

impl Mask {
    /// The grating, if the mask is one.
    #[must_use]
    pub fn grating(&self) -> Option<&Grating> {
        match self {
            Self::Grating(grating) => Some(grating),
            Self::Opaque { .. } | Self::Aperture(_) => None,
        }
    }

    /// The share of radiance that passes at (x, y).
    #[inline]
    #[must_use]
    pub fn transmittance(&self, x: f64, y: f64) -> f64 {
        match self {
            Self::Opaque {
                shapes,
                half_planes,
            } => {
                let stopped = shapes.iter().any(|shape| shape.contains(x, y))
                    || half_planes.iter().any(|half| half.contains(x, y));
                f64::from(u8::from(!stopped))
            }
            Self::Grating(grating) => grating.transmittance(x, y),
            Self::Aperture(hole) => hole.transmittance(x, y),
        }
    }
}
