//! Predictions by nets of rays. They are used for chains whose closed form takes too long or does
//! not resolve a pattern.

use crate::model::{Model, Observed, Over, ShiftedModels};
use crate::nets::{RayBudget, RayNets};
use crate::predicted::Predicted;
use crate::rays::Plane;
use crate::{Chain, Parameter, rays, scattering};
use etendue_field::{Brdf, Frame, Fresnel, Lobe, Patch, Quantity, Reflectance, Window};
use glam::DVec3;

/// The system whose rays are summed over nets.
enum NetDomain {
    Rays(Box<Observed<rays::SpecularSystem>>),
    Scattering(Box<Observed<scattering::ScatteringSystem>>),
}

impl Chain {
    /// Returns the prediction by nets of rays, with derivatives with respect to some parameters.
    #[must_use]
    pub fn sampled(
        &self,
        parameters: &[Parameter],
        over: Over<'_>,
        budget: RayBudget,
    ) -> Predicted {
        const ONE_KIND: &str = "a parameter does not change the kind of a chain";
        match self.followed(over.0) {
            NetDomain::Rays(view) => {
                let moved = self.moved(parameters, over, |chain| match chain.followed(over.0) {
                    NetDomain::Rays(view) => *view,
                    NetDomain::Scattering(_) => unreachable!("{ONE_KIND}"),
                });
                rays::predict(&view, &moved, over, budget)
            }
            NetDomain::Scattering(view) => {
                let moved = self.moved(parameters, over, |chain| match chain.followed(over.0) {
                    NetDomain::Scattering(view) => *view,
                    NetDomain::Rays(_) => unreachable!("{ONE_KIND}"),
                });
                let chain = scattering::chain(&view);
                scattering::predict(&view, chain.as_ref(), &moved, over, budget)
            }
        }
    }

    /// Calls a function with the nets of rays that [`sampled`](Self::sampled) sums.
    pub(super) fn with_sampled(
        &self,
        over: Over<'_>,
        budget: RayBudget,
        then: &mut dyn FnMut(&dyn RayNets),
    ) {
        match self.followed(over.0) {
            NetDomain::Rays(view) => view.with_rays(over, budget, then),
            NetDomain::Scattering(view) => view.with_rays(over, budget, then),
        }
    }

    /// Returns, for each parameter, the system with this parameter slightly increased and slightly
    /// decreased.
    fn moved<V>(
        &self,
        parameters: &[Parameter],
        over: Over<'_>,
        into: impl Fn(Self) -> V,
    ) -> Vec<ShiftedModels<V>> {
        // Steps of parameters of masks move shadows. They are large enough for some rays to cross the
        // shadow's edge, and small enough to change phases by at most a third of a radian.
        const RELATIVE_STEP: f64 = 1e-2;
        const TURNS: f64 = 0.05;
        let moved = |parameter: &Parameter| {
            let step = self.step(*parameter, (over.0, over.1), [RELATIVE_STEP, TURNS])?;
            ShiftedModels::new(self, *parameter, step, &into)
        };
        let moved: Option<Vec<_>> = parameters.iter().map(moved).collect();
        moved.expect("parameters of the chain")
    }

    /// Returns the chain as a system of rays or, if it ends in a diffuse reflection, as a flat
    /// surface that scatters.
    fn followed(&self, window: &Window) -> NetDomain {
        let path = self.path();
        let layers = path.layers.iter();
        let distance = path.distance;
        let layers = layers.map(|layer| (distance - layer.distance, layer.mask.clone()));
        let (light, layers) = (self.source.light.clone(), layers.collect());
        let Some(reflection) = path.reflection else {
            let mut plane = Plane::orthogonal(Frame::IDENTITY.travelled(distance));
            if path.cosines > 0 {
                plane.quantity = Quantity::DifferentialIrradiance;
            }
            let system = rays::SpecularSystem {
                light,
                layers,
                obstacles: Vec::new(),
                elements: Vec::new(),
            };
            return NetDomain::Rays(Box::new(Observed { system, plane }));
        };
        let facing = Frame {
            origin: DVec3::Z * distance,
            x: DVec3::NEG_X,
            y: DVec3::Y,
            d: DVec3::NEG_Z,
        };
        let system = scattering::ScatteringSystem {
            light,
            layers,
            obstacles: Vec::new(),
            name: String::new(),
            patch: Patch {
                frame: facing,
                curvature: [0.0; 3],
                aperture: seen(window, reflection.after),
            },
            reflectance: diffuse(reflection.albedo),
        };
        let plane = Plane::orthogonal(facing.travelled(reflection.after));
        NetDomain::Scattering(Box::new(Observed { system, plane }))
    }
}

/// Returns a width that is larger than the part of the receiver seen through a window at the given
/// distance.
fn seen(window: &Window, distance: f64) -> f64 {
    let [x, y, u, v] = [window.x, window.y, window.u, window.v].map(|p| p.half_width());
    2.0 * libm::hypot(x + distance * u, y + distance * v)
}

fn diffuse(albedo: f64) -> Reflectance {
    Brdf::new(Lobe::Lambertian, albedo, Fresnel::White).into()
}
