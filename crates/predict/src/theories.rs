//! The theories that predict a windowed light field.

use crate::chain::chain;
use crate::theory_input::path;
use etendue_field::{Orientation, VirtualPlane};
use etendue_scene::Scene;
use etendue_theory::{
    Chain, Model, Observed, Over, Parameter, PathKind, PredictionWork, RayBudget,
};

/// The theories that predict a windowed light field.
#[derive(Clone, Debug)]
pub enum Theory {
    /// Light between parallel planes. The prediction is a closed form, or a quadrature over a flat
    /// receiver.
    Parallel(Chain),
    /// Rays along a path over surfaces in any position; also light of a picture that meets no
    /// surface.
    Path(Box<Observed>),
    /// No theory applies, and another measurement takes the place of a prediction.
    None,
}

impl Theory {
    /// The theory that covers the objects on the central ray. Its assumptions are not checked
    /// here.
    #[must_use]
    pub fn of(scene: &Scene, plane: &VirtualPlane) -> Self {
        Self::first(scene, plane, path(scene, plane).as_ref())
    }

    /// The theory that is tried first: for a path over smooth surfaces the theory of this
    /// path, and otherwise the theory of parallel planes. `view` is the path to the plane, if it
    /// has a theory.
    pub(crate) fn first(scene: &Scene, plane: &VirtualPlane, view: Option<&Observed>) -> Self {
        let is_straight = plane.leg == 0 && plane.orientation == Orientation::Orthogonal;
        let is_smooth = |view: &&Observed| match view.kind() {
            PathKind::Specular => scene.light.is_picture() || !is_straight,
            PathKind::Scattered => true,
            PathKind::Several => false,
        };
        match view.filter(is_smooth) {
            Some(view) => Self::Path(Box::new(view.clone())),
            None => Self::Parallel(chain(scene, plane)),
        }
    }

    /// The path of the theory, if it has one.
    #[must_use]
    pub fn path(&self) -> Option<&Observed> {
        match self {
            Self::Path(view) => Some(view),
            Self::Parallel(_) | Self::None => None,
        }
    }

    /// The path of the theory if its rays are sampled in the given way.
    #[must_use]
    pub fn path_of(&self, kind: PathKind) -> Option<&Observed> {
        self.path().filter(|view| view.kind() == kind)
    }

    /// The assumptions that the theory makes about a scene. Each assumption is checked
    /// where the theory applies.
    #[must_use]
    pub fn assumptions(&self) -> &'static [&'static str] {
        match self {
            Self::Parallel(_) => &[
                "all objects that light meets lie in planes orthogonal to the path",
                "no edge of the receiver is in view",
            ],
            Self::Path(_) | Self::None => &[],
        }
    }

    /// The parameters of the theory's model that a measurement can estimate.
    pub(crate) fn parameters(&self) -> Vec<Parameter> {
        match self {
            Self::Parallel(chain) => chain.parameters(),
            Self::Path(view) => view.parameters(),
            Self::None => Vec::new(),
        }
    }

    /// The work of a prediction by the theory's model.
    pub(crate) fn work(&self, over: Over<'_>, budget: RayBudget) -> PredictionWork {
        match self {
            Self::Parallel(chain) => chain.work(over, budget),
            Self::Path(view) => view.work(over, budget),
            Self::None => PredictionWork::none(),
        }
    }
}
