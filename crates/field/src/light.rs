//! Lights of a scene, and their extent in position and slope.

use crate::{Environment, Image, RayLight, Shape};
use serde::{Serialize, Serializer};
use std::sync::Arc;

/// A light in a plane that is perpendicular to the central ray; the light shines along the ray.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Light {
    /// A flat area light.
    Area {
        /// The shape of the light.
        shape: Shape,
        /// Radiance L₀ along the central ray, W m⁻² sr⁻¹.
        radiance: f64,
        /// Exponent n of the radiance L₀ cosⁿθ. With 0, the light is Lambertian; with larger
        /// values, it is a spotlight.
        exponent: f64,
    },
    /// A point on the central ray, with the same intensity in all directions.
    Point {
        /// Intensity, W sr⁻¹.
        intensity: f64,
    },
    /// A slide projector, which is a point on the central ray. Its intensity varies over the slopes
    /// (u, v) like a picture.
    Projector {
        /// Intensity, in W sr⁻¹, where the picture has the value 1.
        intensity: f64,
        /// The picture.
        image: Image,
    },
    /// A collimated beam along the central ray, whose irradiance varies over (x, y) like a picture.
    Beam {
        /// Irradiance, in W m⁻², where the picture has the value 1.
        irradiance: f64,
        /// The picture.
        image: Image,
    },
    /// Light from infinity.
    Environment {
        /// The environment map and its axes.
        environment: Environment,
    },
    /// A finite list of rays, read from a ray file.
    Rays {
        /// The rays.
        #[serde(serialize_with = "shared")]
        rays: Arc<RayLight>,
    },
}

fn shared<S: Serializer>(rays: &Arc<RayLight>, serializer: S) -> Result<S::Ok, S::Error> {
    rays.as_ref().serialize(serializer)
}

impl Light {
    /// The picture through which the light shines, if any.
    #[must_use]
    pub fn image(&self) -> Option<&Image> {
        match self {
            Self::Projector { image, .. } | Self::Beam { image, .. } => Some(image),
            _ => None,
        }
    }

    /// The flat shape of the light, if any.
    #[must_use]
    pub fn shape(&self) -> Option<&Shape> {
        match self {
            Self::Area { shape, .. } => Some(shape),
            _ => None,
        }
    }

    /// Checks whether the light shines through a picture.
    #[must_use]
    pub fn is_picture(&self) -> bool {
        self.image().is_some()
    }

    /// Checks whether a point can receive light from more than one direction. Backward rays can
    /// hit only lights for which this is true.
    #[must_use]
    pub fn has_extent(&self) -> bool {
        match self {
            Self::Area { .. } | Self::Environment { .. } => true,
            Self::Point { .. } | Self::Projector { .. } | Self::Beam { .. } | Self::Rays { .. } => {
                false
            }
        }
    }

    /// Checks whether the light shines along the same directions everywhere, like an environment.
    #[must_use]
    pub fn is_distant(&self) -> bool {
        matches!(self, Self::Beam { .. } | Self::Environment { .. })
    }

    /// The lowest and highest coordinate along x or y (0 or 1) of the light's points in
    /// its plane, metres. The coordinates are infinite for an environment.
    #[must_use]
    pub fn extent(&self, axis: usize) -> [f64; 2] {
        let half = match self {
            Self::Area { shape, .. } => return shape.bounds().extent(axis),
            Self::Point { .. } | Self::Projector { .. } => 0.0,
            Self::Beam { image, .. } => image.reach()[axis],
            Self::Environment { .. } => f64::INFINITY,
            Self::Rays { rays } => return rays.extent(axis),
        };
        [-half, half]
    }

    /// The largest slope of the light along x or y (0 or 1). The result is infinite if the
    /// slopes are unbounded.
    #[must_use]
    pub fn steepest(&self, axis: usize) -> f64 {
        match self {
            Self::Projector { image, .. } => image.reach()[axis],
            Self::Beam { .. } => 0.0,
            Self::Rays { rays } => rays.steepest(axis),
            Self::Area { .. } | Self::Point { .. } | Self::Environment { .. } => f64::INFINITY,
        }
    }
}
