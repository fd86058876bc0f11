//! Predictions by nets of rays. They are used for chains whose closed form takes too long or does
//! not resolve a pattern.

use crate::model::{Model, Over, STEPS_OF_EDGES, ShiftedModels};
use crate::nets::RayBudget;
use crate::path::{Interaction, Observed, PathMask, PathSurface, PathSystem};
use crate::plane::Plane;
use crate::predicted::Predicted;
use crate::{Chain, Parameter};
use etendue_field::{Brdf, Frame, Fresnel, Lobe, Patch, Quantity, Reflectance, Side, Window};
use glam::DVec3;

impl Chain {
    /// The prediction by nets of rays, with derivatives with respect to some parameters.
    ///
    /// # Panics
    /// Panics if the chain has no such parameter.
    #[must_use]
    pub fn sampled(
        &self,
        parameters: &[Parameter],
        over: Over<'_>,
        budget: RayBudget,
    ) -> Predicted {
        let moved = |parameter: &Parameter| {
            let step = self.step(*parameter, (over.0, over.1), STEPS_OF_EDGES)?;
            ShiftedModels::new(self, *parameter, step, |chain| chain.followed(over.0))
        };
        let moved: Option<Vec<_>> = parameters.iter().map(moved).collect();
        let moved = moved.expect("parameters of the chain");
        self.followed(over.0).predicted(&moved, over, budget)
    }

    /// The chain as a path, which has a flat surface that scatters if the chain ends in a
    /// diffuse reflection.
    pub(super) fn followed(&self, window: &Window) -> Observed {
        let path = self.path();
        let distance = path.distance;
        let mut system = PathSystem::new(self.source.light.clone(), Vec::new());
        let masks = path.layers.iter();
        let masks = masks.map(|layer| PathMask {
            name: String::new(),
            distance: distance - layer.distance,
            mask: layer.mask.clone(),
        });
        system.masks = masks.collect();
        let Some(reflection) = path.reflection else {
            let mut plane = Plane::orthogonal(Frame::IDENTITY.travelled(distance));
            // All masks of the chain stand before the plane, even those at its distance.
            plane.side = Side::After;
            if path.cosines > 0 {
                plane.quantity = Quantity::DifferentialIrradiance;
            }
            return Observed { system, plane };
        };
        let facing = Frame {
            origin: DVec3::Z * distance,
            x: DVec3::NEG_X,
            y: DVec3::Y,
            d: DVec3::NEG_Z,
        };
        let patch = Patch {
            frame: facing,
            curvature: [0.0; 3],
            aperture: seen(window, reflection.after),
        };
        let interaction = Interaction::Reflects(Box::new(diffuse(reflection.albedo)));
        system.surfaces = vec![PathSurface::new("", patch, interaction)];
        system.visited = 1;
        let plane = Plane::orthogonal(facing.travelled(reflection.after));
        Observed { system, plane }
    }
}

/// A width that is larger than the part of the receiver seen through a window at the given
/// distance.
fn seen(window: &Window, distance: f64) -> f64 {
    let [x, y, u, v] = [window.x, window.y, window.u, window.v].map(|p| p.half_width());
    2.0 * libm::hypot(x + distance * u, y + distance * v)
}

fn diffuse(albedo: f64) -> Reflectance {
    Brdf::new(Lobe::Lambertian, albedo, Fresnel::White).into()
}
