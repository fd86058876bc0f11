//! Lights of a scene, and how far they reach.

use crate::{Environment, Image, RayLight, Shape};
use serde::{Serialize, Serializer};
use std::sync::Arc;

/// Widths at which a Gaussian picture is below 10⁻¹² of its peak, and where photons end.
const PICTURE: f64 = 3.0;

/// A light in a plane across the central ray, shining along it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Light {
    /// A flat shape.
    Area {
        /// The shape.
        shape: Shape,
        /// Radiance L₀ along the central ray, W m⁻² sr⁻¹.
        radiance: f64,
        /// n in the radiance L₀ cosⁿθ; 0 is Lambertian, more is a spot.
        exponent: f64,
    },
    /// A point on the central ray, the same intensity in all directions.
    Point {
        /// Intensity, W sr⁻¹.
        intensity: f64,
    },
    /// A slide projector: a point on the central ray whose intensity is a picture over slopes (u, v).
    Projector {
        /// Intensity where the picture is 1, W sr⁻¹.
        intensity: f64,
        /// The picture.
        image: Image,
    },
    /// A collimated beam along the central ray whose irradiance is a picture over (x, y).
    Beam {
        /// Irradiance where the picture is 1, W m⁻².
        irradiance: f64,
        /// The picture.
        image: Image,
    },
    /// Light from far away.
    Environment {
        /// From where how much.
        environment: Environment,
    },
    /// Finitely many rays, those of a ray file.
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
    /// The picture it shines through.
    #[must_use]
    pub fn image(&self) -> Option<&Image> {
        match self {
            Self::Projector { image, .. } | Self::Beam { image, .. } => Some(image),
            _ => None,
        }
    }

    /// The flat shape that shines.
    #[must_use]
    pub fn shape(&self) -> Option<&Shape> {
        match self {
            Self::Area { shape, .. } => Some(shape),
            _ => None,
        }
    }

    /// Whether it shines through a picture.
    #[must_use]
    pub fn is_picture(&self) -> bool {
        self.image().is_some()
    }

    /// Whether it comes to a point from more than one direction. Backward rays hit no other.
    #[must_use]
    pub fn has_extent(&self) -> bool {
        matches!(self, Self::Area { .. } | Self::Environment { .. })
    }

    /// Whether it shines along the same directions everywhere, as from far away.
    #[must_use]
    pub fn is_distant(&self) -> bool {
        matches!(self, Self::Beam { .. } | Self::Environment { .. })
    }

    /// The lowest and highest coordinate along x or y (0 or 1) of the points in its plane from which
    /// it shines, metres. Infinite for an environment.
    #[must_use]
    pub fn extent(&self, axis: usize) -> [f64; 2] {
        let half = match self {
            Self::Area { shape, .. } => return shape.bounds().extent(axis),
            Self::Point { .. } | Self::Projector { .. } => 0.0,
            Self::Beam { image, .. } => PICTURE * image.width[axis],
            Self::Environment { .. } => f64::INFINITY,
            Self::Rays { rays } => return rays.extent(axis),
        };
        [-half, half]
    }

    /// The largest slope along x or y (0 or 1) with which it shines. Infinite where it has no end.
    #[must_use]
    pub fn steepest(&self, axis: usize) -> f64 {
        match self {
            Self::Projector { image, .. } => PICTURE * image.width[axis],
            Self::Beam { .. } => 0.0,
            Self::Rays { rays } => rays.steepest(axis),
            Self::Area { .. } | Self::Point { .. } | Self::Environment { .. } => f64::INFINITY,
        }
    }
}
