use crate::Texture;
use etendue_field::Raster;
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
        /// Half of the angle beyond which it is dark, radians. Between both, intensity falls linearly with the angle.
        cutoff: f64,
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

/// Radiance from far away, by direction: pixels over longitude and latitude, bilinear between their centres.
///
/// In coordinates of the map, Y is up. With `w` columns and `h` rows, light from (x, y, z) is at column w · atan2(x, −z) / 2π, which goes round, and
/// at row ½ + (h − 1) · acos(y) / π. The centre of the first pixel is at column ½ and row ½: so those of the first row are at the upper pole, of the last at
/// the lower one, and columns are apart by 2π / w. Mitsuba 3 has it so.
#[derive(Clone, Debug)]
pub struct SkyMap {
    /// Rotates directions of the map to those of the world.
    pub to_world: DMat3,
    /// W m⁻² sr⁻¹.
    pub radiance: Arc<Raster>,
}

/// Radiance of a surface on its front, the same to all directions: an area light.
pub type Emission = Texture;
