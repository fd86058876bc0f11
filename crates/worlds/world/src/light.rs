//! Lights that are not surfaces.

use crate::Texture;
use etendue_field::LatLong;
use glam::{DAffine3, DMat3, DVec2, DVec3};
use std::sync::Arc;

/// A light that is not a surface.
#[derive(Clone, Debug)]
pub enum Light {
    /// A point light that emits in all directions.
    Point {
        /// The position of the light.
        position: DVec3,
        /// W sr⁻¹.
        intensity: f64,
    },
    /// A point light that emits into a cone around the Z axis of `to_world`.
    Spot {
        /// The position and orientation of the light, without scale.
        to_world: DAffine3,
        /// Intensity within `beam`, W sr⁻¹.
        intensity: f64,
        /// Half-angle of the cone of full intensity, radians.
        beam: f64,
        /// Half-angle beyond which the spot is dark, radians.
        cutoff: f64,
        /// The falloff of intensity between the two angles.
        falloff: Falloff,
        /// A texture that multiplies the intensity, as in Mitsuba 3. In the direction (x, y, z) of
        /// the light, the factor is the value at the texture coordinates ½ + ½ (x, y)/(z tan
        /// `cutoff`).
        picture: Option<Texture>,
    },
    /// A point light that projects a picture along the Z axis of `to_world`, as in Mitsuba 3.
    Projector {
        /// The position and orientation of the light, without scale.
        to_world: DAffine3,
        /// Half of the width and height of the picture at distance 1.
        half: DVec2,
        /// Intensity along Z, W sr⁻¹; it is larger by 1/cos³ θ at an angle θ to Z, so that the
        /// picture is even on a plane. The direction (x, y, z) of the light has the value at the
        /// texture coordinates ½ − ½ (x, y)/(z `half`).
        picture: Texture,
        /// A factor on the picture.
        scale: f64,
    },
    /// A distant light in a single direction.
    Directional {
        /// The direction in which the light travels, of unit length.
        direction: DVec3,
        /// Irradiance of a surface perpendicular to this direction, W m⁻².
        irradiance: f64,
    },
    /// Light that leaves the front of a flat shape along its normal, and in no other direction.
    Sheet {
        /// The index of the shape, a rectangle or a disc.
        shape: usize,
        /// Power per area of the shape, W m⁻².
        exitance: Texture,
    },
    /// Uniform radiance from all directions.
    Constant {
        /// W m⁻² sr⁻¹.
        radiance: f64,
    },
    /// Radiance by direction.
    Sky(SkyMap),
}

/// The falloff of a spot's intensity from its beam to the dark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Falloff {
    /// Falloff that is linear in the angle, as in Mitsuba 3.
    Angle,
    /// Falloff as t² (3 − 2t), as in pbrt-v4; t goes from 1 to 0 linearly with the cosine of the
    /// angle.
    SmoothCosine,
    /// Falloff as t², as recommended by glTF 2.0.
    SquaredCosine,
}

impl Falloff {
    /// The fraction of the intensity at an angle, for a beam and a cutoff.
    #[must_use]
    pub fn share(self, angle: f64, beam: f64, cutoff: f64) -> f64 {
        // If both angles are equal, the beam has a sharp edge.
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

/// Distant radiance by direction.
#[derive(Clone, Debug)]
pub struct SkyMap {
    /// Rotates directions of the map to directions of the world.
    pub to_world: DMat3,
    /// W m⁻² sr⁻¹.
    pub radiance: Arc<LatLong>,
}

/// The radiance that a surface emits, equal in all directions on a side.
pub type EmittedRadiance = Texture;
