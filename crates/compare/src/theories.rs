//! The theories that predict a windowed light field.

use crate::chain::chain;
use crate::theory_input::{scattered, system};
use etendue_field::{Mask, Orientation, VirtualPlane};
use etendue_scene::{BlockerLayer, Scene};
use etendue_theory::{
    Chain, Model, Observed, Over, Parameter, PredictionWork, RayBudget, rays, reflections,
    scattering,
};

/// The theories that predict a windowed light field.
#[derive(Clone, Debug)]
pub enum Theory {
    /// Light between parallel planes. The prediction is a closed form, or a quadrature over a flat
    /// receiver.
    Parallel(Chain),
    /// Rays traced through smooth specular surfaces, or through pictures.
    Specular(Box<Observed<rays::SpecularSystem>>),
    /// Light that one smooth surface reflects by a BRDF.
    Scattering(Box<Observed<scattering::ScatteringSystem>>),
    /// Light that several surfaces scatter in turn, or light that one surface scatters if its own
    /// shadow or its edges matter.
    Reflections(Box<Observed<reflections::ReflectionSystem>>),
    /// No theory applies, and another measurement takes the place of a prediction.
    None,
}

impl Theory {
    /// Returns the theory that covers the objects that the central ray meets on its way to a plane.
    /// The assumptions of the theory are not checked here.
    #[must_use]
    pub fn of(scene: &Scene, plane: &VirtualPlane) -> Self {
        if let Some(view) = followed(scene, plane) {
            Self::Specular(Box::new(view))
        } else if let Some(view) = scattered(scene, plane) {
            Self::Scattering(Box::new(view))
        } else {
            Self::Parallel(chain(scene, plane))
        }
    }

    /// Checks whether the theory assumes that all light meets the blockers of a layer before it
    /// meets a surface.
    pub(crate) fn has_all_light_meet(&self, layer: &BlockerLayer) -> bool {
        let layers = match self {
            Self::Specular(view) => &view.system.layers,
            Self::Scattering(view) => &view.system.layers,
            Self::Reflections(_) => return false,
            Self::Parallel(_) | Self::None => return true,
        };
        layers.iter().any(|known| is_same(known, layer))
    }

    /// Returns the assumptions that the theory makes about a scene. Each assumption is checked
    /// where the theory applies.
    #[must_use]
    pub fn assumptions(&self) -> &'static [&'static str] {
        const FOLLOWED: &[&str] = &[
            "light meets each surface once, in the order of the path, and no surface is in its own shadow",
        ];
        match self {
            Self::Parallel(_) => &[
                "all objects that light meets lie in planes orthogonal to the path",
                "no edge of the receiver is in view",
            ],
            Self::Specular(_) | Self::Scattering(_) => FOLLOWED,
            Self::Reflections(_) | Self::None => &[],
        }
    }

    /// Returns the parameters of the theory's model that a measurement can estimate.
    pub(crate) fn parameters(&self) -> Vec<Parameter> {
        match self {
            Self::Parallel(chain) => chain.parameters(),
            Self::Specular(view) => view.parameters(),
            Self::Scattering(view) => view.parameters(),
            Self::Reflections(view) => view.parameters(),
            Self::None => Vec::new(),
        }
    }

    /// Returns the work of a prediction by the theory's model.
    pub(crate) fn work(&self, over: Over<'_>, budget: RayBudget) -> PredictionWork {
        match self {
            Self::Parallel(chain) => chain.work(over, budget),
            Self::Specular(view) => view.work(over, budget),
            Self::Scattering(view) => view.work(over, budget),
            Self::Reflections(view) => view.work(over, budget),
            Self::None => PredictionWork::none(),
        }
    }
}

/// Returns the system of specular surfaces that leads to a plane. The plane lies behind one of
/// these surfaces or on one of them. Light that passes through a picture and meets no surface also
/// has such a system.
fn followed(scene: &Scene, plane: &VirtualPlane) -> Option<Observed<rays::SpecularSystem>> {
    let across = plane.orientation == Orientation::Orthogonal;
    if !scene.light.is_picture() && plane.leg == 0 && across {
        return None;
    }
    system(scene, plane)
}

pub(crate) fn is_same((distance, mask): &(f64, Mask), layer: &BlockerLayer) -> bool {
    distance.total_cmp(&layer.distance).is_eq() && *mask == layer.mask
}
