//! Which theory applies to a plane, decided once.

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

/// What theory says of a plane: which one applies, or why none does.
#[derive(Clone, Debug)]
pub struct Applicability {
    /// The theory, with what it needs to know of the scene.
    pub theory: Theory,
    /// What light meets on its way that no theory describes, in words; empty where one applies.
    pub reasons: Vec<String>,
    /// What keeps a theory of fewer surfaces from the plane, in words, where that of several surfaces
    /// takes its place; else empty.
    pub declined: Vec<String>,
    /// Why no light reaches the plane, in words; `None` where some may.
    pub dark: Option<String>,
    /// How far smooth meshes lead rays beside where their osculating patches do; `None` without one.
    pub off_patches: Option<OffPatches>,
}

impl Theory {
    /// What of a scene is not as the theory takes it to be, in words. Blockers that light meets where
    /// the central ray does not become obstacles of the theory.
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

    /// Makes an obstacle of blockers that light meets from a leg on.
    fn take(&mut self, layer: &BlockerLayer, from: usize) {
        let (layers, obstacles) = match self {
            Self::Specular(view) => (&mut view.system.layers, &mut view.system.obstacles),
            Self::Scattering(view) => (&mut view.system.layers, &mut view.system.obstacles),
            Self::Parallel(_) | Self::Reflections(_) | Self::None => return,
        };
        // Not twice on the first leg.
        layers.retain(|known| from > 0 || !is_same(known, layer));
        obstacles.push(in_the_way(layer, from));
    }
}

/// Share of its distance by which a plane stands off what is right at it: more than rounding, and far below what phases show.
const AT_PLANE: f64 = 1e-12;

impl Applicability {
    /// Decides for all planes of a scene.
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
        // Rays of the first leg are followed past what does not lie across it.
        let Some(mut view) = system(scene, plane) else {
            return found;
        };
        if plane.orientation == Orientation::Orthogonal {
            // A plane right after something is at the same distance.
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
        // Light that goes other ways than theory's might pass beside what stands in these.
        let dark = unlit::reason(scene, plane, &theory);
        Self {
            theory,
            reasons,
            declined,
            dark,
            off_patches,
        }
    }

    /// The kind of prediction.
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

    /// The chain of affine maps that leads to a plane behind specular surfaces, by the paper's
    /// printed formulas where the scene asks for them.
    #[must_use]
    pub fn affine_chain(&self, scene: &Scene) -> Option<rays::AffineChain> {
        match &self.theory {
            Theory::Specular(view) => rays::chain(view, print(scene)),
            _ => None,
        }
    }

    /// The steps that make the spectrum of the plane, a line for each: the chain, what no theory
    /// describes, and the window last.
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
            // What shines is described alike; how it travels, by the maps, or by none.
            steps.truncate(1);
            steps.extend(maps);
        }
        let unknown = self.reasons.iter();
        steps.extend(unknown.map(|reason| format!("without theory  {reason}")));
        steps.extend(self.dark.iter().map(|reason| format!("dark  {reason}")));
        steps.push(format!(
            "multiply  window: x {x:?}, y {y:?}, u {u:?}, v {v:?}"
        ));
        steps
    }
}
