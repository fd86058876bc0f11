//! A chain whose closed form takes too long, or does not resolve a pattern: the same light by nets
//! of rays.

use crate::nets::{Budget, Moved};
use crate::parallel::chain::Path;
use crate::{Chain, Parameter, rays, scattering};
use etendue_field::{
    Brdf, Frame, Fresnel, Lobe, Mask, Orientation, Patch, Projection, Quantity, Reflectance,
    Slices, Window,
};
use glam::DVec3;

/// A prediction of a chain by nets.
#[derive(Clone, Debug, PartialEq)]
pub struct Sampled {
    /// The slices of the windowed spectrum: the mean of the replicates.
    pub slices: Slices,
    /// Independent predictions, none of which is biased.
    pub replicates: Vec<Slices>,
    /// ‖error‖/‖F‖: the standard error of the mean.
    pub error: f64,
    /// The windowed light field integrated over y and v.
    pub projection: Projection,
    /// The derivative of the slices by each of the parameters asked for, per unit.
    pub derivatives: Vec<Slices>,
}

/// What nets sum over.
enum Model {
    Rays(rays::System),
    Scattering(Box<scattering::System>),
}

impl Chain {
    /// Whether nodes on the receiver tell apart all that shines on it; true where there is none.
    #[must_use]
    pub fn is_resolved(&self, window: &Window) -> bool {
        let receiver = self.path().receiver();
        receiver.is_none_or(|receiver| receiver.is_resolved(window))
    }

    /// Whether a diffuse surface reflects the light at its end.
    #[must_use]
    pub fn is_reflected(&self) -> bool {
        self.path().reflection.is_some()
    }

    /// The prediction by nets of rays, with derivatives by some parameters.
    #[must_use]
    pub fn sampled(
        &self,
        parameters: &[Parameter],
        over: rays::Over<'_>,
        budget: Budget,
    ) -> Sampled {
        let (model, plane) = self.model(over.0);
        match model {
            Model::Rays(system) => {
                let found = rays::exact(&system, &plane, over, budget);
                let moved = self.moved(parameters, over, |chain| match chain.model(over.0) {
                    (Model::Rays(system), plane) => (system, plane),
                    (Model::Scattering(_), _) => {
                        unreachable!("a parameter changes no kind of chain")
                    }
                });
                Sampled {
                    derivatives: rays::derivatives(&moved, over, &found),
                    slices: found.slices,
                    replicates: found.replicates,
                    error: found.error,
                    projection: found.projection,
                }
            }
            Model::Scattering(system) => {
                let chain = scattering::chain(&system, &plane);
                let found = scattering::predict(&system, &plane, chain.as_ref(), over, budget);
                let moved = self.moved(parameters, over, |chain| match chain.model(over.0) {
                    (Model::Scattering(system), plane) => (*system, plane),
                    (Model::Rays(_), _) => unreachable!("a parameter changes no kind of chain"),
                });
                let two = (over.0, over.1);
                let around = scattering::differences(&system, &plane, None, &moved, two, &found);
                Sampled {
                    derivatives: around.derivatives,
                    slices: found.slices,
                    replicates: found.replicates,
                    error: found.error,
                    projection: found.projection,
                }
            }
        }
    }

    /// The models with a little more and a little less of each parameter.
    fn moved<S>(
        &self,
        parameters: &[Parameter],
        over: rays::Over<'_>,
        model: impl Fn(&Self) -> (S, rays::Plane),
    ) -> Vec<Moved<(S, rays::Plane)>> {
        // Shadows move with masks: wide enough apart that some rays see it, and so near that phases
        // turn by a third of a radian at most.
        const STEP: f64 = 1e-2;
        const PHASE: f64 = 0.05;
        let moved = |parameter: &Parameter| {
            let value = self.value(*parameter);
            let size = if value == 0.0 { 1.0 } else { value.abs() };
            let most = match parameter {
                Parameter::SpotExponent | Parameter::GratingPhase(_) => f64::INFINITY,
                Parameter::GratingFrequency(_) => PHASE / over.0.x.half_width(),
                Parameter::SourceSize
                | Parameter::Travel(_)
                | Parameter::BlockerSide(_)
                | Parameter::HalfPlaneEdge(_) => PHASE / over.1.rho.max().max(f64::MIN_POSITIVE),
            };
            let step = (STEP * size).min(most);
            let at = |value| model(&self.with(*parameter, value));
            Moved {
                apart: 2.0 * step,
                sides: [at(value + step), at(value - step)],
            }
        };
        parameters.iter().map(moved).collect()
    }

    /// The chain as a system of rays, or as a flat surface that scatters.
    fn model(&self, window: &Window) -> (Model, rays::Plane) {
        let path = self.path();
        let masks = |path: &Path<'_>| -> Vec<(f64, Mask)> {
            let layers = path.layers.iter();
            layers
                .map(|layer| (path.distance - layer.distance, layer.mask.clone()))
                .collect()
        };
        let across = rays::Plane {
            frame: Frame::IDENTITY.travelled(path.distance),
            orientation: Orientation::Orthogonal,
            longitude: 0.0,
            patch: None,
            arriving: false,
            quantity: if path.cosines > 0 {
                Quantity::DifferentialIrradiance
            } else {
                Quantity::Radiance
            },
        };
        let Some(reflection) = path.reflection else {
            let system = rays::System {
                light: path.light.light(),
                layers: masks(&path),
                elements: Vec::new(),
            };
            return (Model::Rays(system), across);
        };
        let after = reflection.after;
        let reach = |x: f64, u: f64| x + after * u;
        let [x, y, u, v] = [window.x, window.y, window.u, window.v].map(|p| p.half_width());
        let facing = Frame {
            origin: DVec3::Z * path.distance,
            x: DVec3::NEG_X,
            y: DVec3::Y,
            d: DVec3::NEG_Z,
        };
        let patch = Patch {
            frame: facing,
            curvature: [0.0; 3],
            aperture: 2.0 * reach(x, u).hypot(reach(y, v)),
        };
        let brdf = Brdf {
            lobe: Lobe::Lambertian,
            albedo: reflection.albedo,
            fresnel: Fresnel::White,
        };
        let system = scattering::System {
            light: path.light.light(),
            layers: masks(&path),
            name: String::new(),
            patch,
            reflectance: Reflectance {
                brdf,
                blend: None,
                texture: None,
            },
        };
        let plane = rays::Plane {
            frame: facing.travelled(after),
            quantity: Quantity::Radiance,
            ..across
        };
        (Model::Scattering(Box::new(system)), plane)
    }
}
