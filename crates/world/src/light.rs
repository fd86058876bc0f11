//! Lights that are no surfaces.

use crate::Texture;
use etendue_field::LatLong;
use glam::{DAffine3, DMat3, DVec3};
use std::sync::Arc;

/// A light that is no surface.
#[derive(Clone, Debug)]
pub enum Light {
    /// From a point to all sides.
    Point {
        /// Where.
        position: DVec3,
        /// W sr⁻¹.
        intensity: f64,
    },
    /// From a point into a cone about the Z axis of `to_world`.
    Spot {
        /// Where it is, and where it points to; without scale.
        to_world: DAffine3,
        /// W sr⁻¹ within `beam`.
        intensity: f64,
        /// Half of the angle of full intensity, radians.
        beam: f64,
        /// Half of the angle beyond which it is dark, radians.
        cutoff: f64,
        /// How intensity falls between both.
        falloff: Falloff,
    },
    /// From so far away that all of it goes one way.
    Directional {
        /// The way it goes, of unit length.
        direction: DVec3,
        /// W m⁻² across that direction.
        irradiance: f64,
    },
    /// The same radiance from everywhere around.
    Constant {
        /// W m⁻² sr⁻¹.
        radiance: f64,
    },
    /// Radiance by the direction that it comes from.
    Sky(SkyMap),
}

/// How the intensity of a spot falls from its beam to where it is dark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Falloff {
    /// Linearly with the angle, as in Mitsuba 3.
    Angle,
    /// As t² (3 − 2t), with t from 1 to 0 linearly with the cosine of the angle, as in pbrt-v4.
    SmoothCosine,
    /// As t², as glTF 2.0 advises.
    SquaredCosine,
}

impl Falloff {
    /// The share of the intensity that is left at an angle, of a beam and a cutoff.
    #[must_use]
    pub fn share(self, angle: f64, beam: f64, cutoff: f64) -> f64 {
        // A beam without an edge is sharp.
        let between = |at: f64, full: f64, dark: f64| match full - dark {
            0.0 if at >= full => 1.0,
            0.0 => 0.0,
            width => ((at - dark) / width).clamp(0.0, 1.0),
        };
        match self {
            Self::Angle => between(-angle, -beam, -cutoff),
            Self::SmoothCosine | Self::SquaredCosine => {
                let [at, full, dark] = [angle, beam, cutoff].map(libm::cos);
                let t = between(at, full, dark);
                match self {
                    Self::SmoothCosine => t * t * (3.0 - 2.0 * t),
                    _ => t * t,
                }
            }
        }
    }
}

/// Radiance from far away, by direction.
#[derive(Clone, Debug)]
pub struct SkyMap {
    /// Rotates directions of the map to those of the world.
    pub to_world: DMat3,
    /// W m⁻² sr⁻¹.
    pub radiance: Arc<LatLong>,
}

/// Radiance of a surface on its front, the same to all directions: an area light.
pub type EmittedRadiance = Texture;
