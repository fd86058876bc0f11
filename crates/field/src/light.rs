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

/// The rays that a light emits, whatever the radiance along each ray.
#[derive(Clone, Copy, Debug)]
pub enum EmittedRays<'a> {
    /// Rays from all points of a shape, in all directions. Parts of the shape may be dark.
    OfShape(&'a Shape),
    /// Rays from the origin, in all directions, with the picture over slopes, if any.
    OfPoint(Option<&'a Image>),
    /// Rays along the central ray, with the picture over positions.
    Parallel(&'a Image),
    /// Rays from all points of the plane, in all directions.
    OfSky(&'a Environment),
    /// The rays of a list, and no others.
    Listed(&'a Arc<RayLight>),
}

/// The values of a light that may be changed, each if the light has it.
#[derive(Debug, Default)]
pub struct LightValues<'a> {
    /// The flat shape of the light.
    pub shape: Option<&'a mut Shape>,
    /// The picture through which the light shines.
    pub image: Option<&'a mut Image>,
    /// The exponent n of the factor cosⁿθ.
    pub exponent: Option<&'a mut f64>,
}

impl Light {
    /// The rays that the light emits.
    #[must_use]
    pub fn rays(&self) -> EmittedRays<'_> {
        match self {
            Self::Area { shape, .. } => EmittedRays::OfShape(shape),
            Self::Point { .. } => EmittedRays::OfPoint(None),
            Self::Projector { image, .. } => EmittedRays::OfPoint(Some(image)),
            Self::Beam { image, .. } => EmittedRays::Parallel(image),
            Self::Environment { environment } => EmittedRays::OfSky(environment),
            Self::Rays { rays } => EmittedRays::Listed(rays),
        }
    }

    /// The values of the light that may be changed.
    pub fn values(&mut self) -> LightValues<'_> {
        match self {
            Self::Area {
                shape, exponent, ..
            } => LightValues {
                shape: Some(shape),
                exponent: Some(exponent),
                image: None,
            },
            Self::Projector { image, .. } | Self::Beam { image, .. } => LightValues {
                image: Some(image),
                ..LightValues::default()
            },
            Self::Point { .. } | Self::Environment { .. } | Self::Rays { .. } => {
                LightValues::default()
            }
        }
    }

    /// The flat shape of the light, if any.
    #[must_use]
    pub fn shape(&self) -> Option<&Shape> {
        match self.rays() {
            EmittedRays::OfShape(shape) => Some(shape),
            _ => None,
        }
    }

    /// The picture through which the light shines, if any.
    #[must_use]
    pub fn image(&self) -> Option<&Image> {
        match self.rays() {
            EmittedRays::OfPoint(image) => image,
            EmittedRays::Parallel(image) => Some(image),
            _ => None,
        }
    }

    /// The exponent n if the radiance has a factor cosⁿθ, or 0.
    #[must_use]
    pub fn exponent(&self) -> f64 {
        match self {
            Self::Area { exponent, .. } => *exponent,
            _ => 0.0,
        }
    }

    /// The environment from which the light comes, if any.
    #[must_use]
    pub fn environment(&self) -> Option<&Environment> {
        match self.rays() {
            EmittedRays::OfSky(environment) => Some(environment),
            _ => None,
        }
    }

    /// The rays of a light that is a list of rays.
    #[must_use]
    pub fn listed(&self) -> Option<&Arc<RayLight>> {
        match self.rays() {
            EmittedRays::Listed(rays) => Some(rays),
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
        matches!(self.rays(), EmittedRays::OfShape(_) | EmittedRays::OfSky(_))
    }

    /// Checks whether the light shines along the same directions everywhere, like an environment.
    #[must_use]
    pub fn is_distant(&self) -> bool {
        matches!(
            self.rays(),
            EmittedRays::Parallel(_) | EmittedRays::OfSky(_)
        )
    }

    /// The lowest and highest coordinate along x or y (0 or 1) of the light's points in
    /// its plane, metres. The coordinates are infinite for an environment.
    #[must_use]
    pub fn extent(&self, axis: usize) -> [f64; 2] {
        let half = match self.rays() {
            EmittedRays::OfShape(shape) => return shape.bounds().extent(axis),
            EmittedRays::OfPoint(_) => 0.0,
            EmittedRays::Parallel(image) => image.reach()[axis],
            EmittedRays::OfSky(_) => f64::INFINITY,
            EmittedRays::Listed(rays) => return rays.extent(axis),
        };
        [-half, half]
    }

    /// The largest slope of the light along x or y (0 or 1). The result is infinite if the
    /// slopes are unbounded.
    #[must_use]
    pub fn steepest(&self, axis: usize) -> f64 {
        match self.rays() {
            EmittedRays::OfPoint(Some(image)) => image.reach()[axis],
            EmittedRays::Parallel(_) => 0.0,
            EmittedRays::Listed(rays) => rays.steepest(axis),
            EmittedRays::OfShape(_) | EmittedRays::OfPoint(None) | EmittedRays::OfSky(_) => {
                f64::INFINITY
            }
        }
    }
}
