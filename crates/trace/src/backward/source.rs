//! The lights that a backward ray can find at the beginning of the path.

use crate::radiance::radiance;
use crate::sky::Sky;
use etendue_field::{EmittedRays, Light, Shape, TwoPlane};
use glam::DVec3;

/// The light that a backward ray can find at the beginning of the path.
#[derive(Debug)]
pub(super) enum TracedLight {
    /// An area light that the ray hits.
    Area { light: Light, shape: Shape },
    /// Light from an environment.
    Sky(Sky),
    /// A point light, a projector or a beam, towards which backward rays are drawn.
    Narrow(Light),
}

impl TracedLight {
    pub(super) fn new(light: &Light) -> Self {
        match light.rays() {
            EmittedRays::OfShape(shape) => Self::Area {
                light: light.clone(),
                shape: *shape,
            },
            EmittedRays::OfSky(environment) => Self::Sky(Sky::new(environment)),
            EmittedRays::OfPoint(_) | EmittedRays::Parallel(_) | EmittedRays::Listed(_) => {
                Self::Narrow(light.clone())
            }
        }
    }

    /// Returns the radiance along an unoccluded ray; for light without extent, returns the value
    /// of the ray per du dv or dx dy.
    pub(super) fn radiance(&self, ray: &TwoPlane) -> f64 {
        match self {
            Self::Area { light, .. } | Self::Narrow(light) => radiance(light, ray),
            Self::Sky(sky) => sky.radiance(ray),
        }
    }

    /// The density per solid angle of directions that are drawn from a point towards the
    /// light.
    pub(super) fn density_towards(&self, point: DVec3, towards: DVec3) -> f64 {
        let shape = match self {
            Self::Sky(sky) => return sky.density(-towards),
            Self::Area { shape, .. } => shape,
            Self::Narrow(_) => return 0.0,
        };
        let way = -point.z / towards.z;
        let on = point + way * towards;
        let is_on = way > 0.0 && shape.contains(on.x, on.y);
        // r² dω = cos θ dA.
        if is_on {
            way * way / (towards.z.abs() * shape.area())
        } else {
            0.0
        }
    }
}
