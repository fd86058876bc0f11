//! Decides, once for each plane, which theory applies.

use crate::chain::chain;
use crate::class::Class;
use crate::parallel::obstacles_to_theory;
use crate::system::{in_the_way, print, reflected, system, too_fine};
use crate::theories::{Theory, is_same};
use crate::unlit;
use crate::validity::{OffPatches, off_patches, unforeseen_by_rays, unforeseen_by_scattering};
use etendue_field::{Orientation, Side, VirtualPlane, Window};
use etendue_scene::{BlockerLayer, Scene};
use etendue_theory::{rays, reflections, scattering};

/// The theory that applies to a plane, or the reasons why none does.
#[derive(Clone, Debug)]
pub struct Applicability {
    /// The theory, with the facts of the scene that it needs.
    pub theory: Theory,
    /// Descriptions of objects that stand in the way of the light and that no theory covers. The
    /// list is empty where a theory applies.
    pub reasons: Vec<String>,
    /// The reasons why the theory of several surfaces replaces a theory of fewer surfaces. The list
    /// is empty where no theory is replaced.
    pub declined: Vec<String>,
    /// The reason why no light reaches the plane, in words; `None` where light may reach the plane.
    pub dark: Option<String>,
    /// The difference that arises if osculating patches deflect the rays instead of smooth meshes;
    /// `None` without a smooth mesh.
    pub off_patches: Option<OffPatches>,
}

impl Theory {
    /// Describes in words which parts of a scene violate the assumptions of the theory. Light may
    /// meet blockers on a leg where the central ray does not meet them. The function adds these
    /// blockers to the obstacles of the theory.
    fn obstacles(
        &mut self,
        scene: &Scene,
        plane: &VirtualPlane,
        off: Option<OffPatches>,
    ) -> Vec<String> {
        let (mut found, layers) = match self {
            Self::Specular(view) => unforeseen_by_rays(scene, plane, view, off),
            Self::Scattering(view) => unforeseen_by_scattering(scene, plane, view),
            Self::Parallel(_) => return obstacles_to_theory(scene, plane),
            Self::Reflections(_) | Self::None => return Vec::new(),
        };
        for layer in layers {
            self.take(&scene.blockers[layer.index], layer.from);
        }
        found.extend(too_fine(scene));
        found
    }

    /// Adds a layer of blockers as an obstacle. Light meets the layer on the leg `from` and on
    /// later legs.
    fn take(&mut self, layer: &BlockerLayer, from: usize) {
        let (layers, obstacles) = match self {
            Self::Specular(view) => (&mut view.system.layers, &mut view.system.obstacles),
            Self::Scattering(view) => (&mut view.system.layers, &mut view.system.obstacles),
            Self::Parallel(_) | Self::Reflections(_) | Self::None => return,
        };
        // A layer is not added twice on the first leg.
        layers.retain(|known| from > 0 || !is_same(known, layer));
        obstacles.push(in_the_way(layer, from));
    }
}

/// A plane and an object at the same distance are separated by this offset. It is given as a share
/// of the distance. The offset exceeds rounding errors but is too small to change phases visibly.
const AT_PLANE: f64 = 1e-12;

impl Applicability {
    /// Decides which theory applies to each plane of a scene.
    #[must_use]
    pub fn of_planes(scene: &Scene) -> Vec<Self> {
        let planes = scene.planes.iter();
        planes.map(|plane| Self::new(scene, plane)).collect()
    }

    /// Decides which theory applies to a plane of a scene.
    #[must_use]
    pub fn new(scene: &Scene, plane: &VirtualPlane) -> Self {
        let found = Self::of(scene, plane, Theory::of(scene, plane));
        if plane.leg > 0 || found.reasons.is_empty() || !too_fine(scene).is_empty() {
            return found;
        }
        // On the first leg, the theory of rays may apply instead, because it tests rays against
        // objects that do not lie across the leg.
        let Some(mut view) = system(scene, plane) else {
            return found;
        };
        if plane.orientation == Orientation::Orthogonal {
            // A plane directly after an object is at the same distance as the object.
            let off = match plane.side {
                Side::Before => -AT_PLANE,
                Side::After => AT_PLANE,
            };
            view.plane.frame = view.plane.frame.travelled(off * plane.distance);
        }
        let past = Self::of(scene, plane, Theory::Specular(Box::new(view)));
        if past.reasons.is_empty() { past } else { found }
    }

    fn of(scene: &Scene, plane: &VirtualPlane, mut theory: Theory) -> Self {
        let off_patches = match &theory {
            Theory::Specular(view) => off_patches(scene, plane, view),
            _ => None,
        };
        let mut reasons = theory.obstacles(scene, plane, off_patches);
        let mut declined = Vec::new();
        if !reasons.is_empty()
            && too_fine(scene).is_empty()
            && let Some(view) = reflected(scene, plane)
        {
            theory = Theory::Reflections(Box::new(view));
            declined = std::mem::take(&mut reasons);
        }
        if !reasons.is_empty() {
            return Self {
                theory: Theory::None,
                reasons,
                declined,
                dark: None,
                off_patches: None,
            };
        }
        // Objects are known to stop all light only on the paths that the theory assumes. Light on
        // other paths might pass beside these objects.
        let dark = unlit::reason(scene, plane, &theory);
        Self {
            theory,
            reasons,
            declined,
            dark,
            off_patches,
        }
    }

    /// Returns the kind of prediction.
    #[must_use]
    pub fn class(&self) -> Class {
        match self.theory {
            Theory::Parallel(_) => Class::Exact,
            Theory::Specular(_) | Theory::Scattering(_) | Theory::Reflections(_) => {
                Class::FirstOrder
            }
            Theory::None => Class::Reference,
        }
    }

    /// Returns the chain of affine maps that leads to a plane behind specular surfaces. The chain
    /// uses the paper's printed formulas where the scene asks for these formulas.
    #[must_use]
    pub fn affine_chain(&self, scene: &Scene) -> Option<rays::AffineChain> {
        match &self.theory {
            Theory::Specular(view) => rays::chain(view, print(scene)),
            _ => None,
        }
    }

    /// Describes the steps that produce the spectrum of the plane, with one line for each step. The
    /// first lines are the chain and everything that no theory describes, and the last line is the
    /// window.
    #[must_use]
    pub fn steps(&self, scene: &Scene, plane: &VirtualPlane) -> Vec<String> {
        let Window { x, y, u, v } = &plane.window;
        let mut steps = chain(scene, plane).describe();
        let maps = match &self.theory {
            Theory::Specular(_) => self.affine_chain(scene).map(|chain| chain.steps),
            Theory::Scattering(view) => {
                let chain = scattering::chain(view);
                Some(chain.map(|chain| chain.steps).unwrap_or_default())
            }
            Theory::Reflections(view) => {
                let chain = reflections::chain(view);
                Some(chain.map(|chain| chain.steps).unwrap_or_default())
            }
            Theory::None => Some(Vec::new()),
            Theory::Parallel(_) => None,
        };
        if let Some(maps) = maps {
            // The first step, which describes the light source, is kept. The maps, if there are
            // any, replace the steps that describe transport.
            steps.truncate(1);
            steps.extend(maps);
        }
        let unknown = self.reasons.iter();
        steps.extend(unknown.map(|reason| format!("without theory  {reason}")));
        steps.extend(self.dark.iter().map(|reason| format!("dark  {reason}")));
        steps.push(format!(
            "multiply  by the window: x {x:?}, y {y:?}, u {u:?}, v {v:?}"
        ));
        steps
    }
}
