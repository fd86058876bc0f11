//! Decides, once for each plane, which theory applies.

use crate::chain::chain;
use crate::class::Class;
use crate::off_parallel::obstacles_to_theory;
use crate::theories::{Theory, is_same};
use crate::theory_input::{in_the_way, print, reflected, system, too_fine};
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
    /// For each further light of the scene, the theory that applies to its light; `None` if the
    /// plane lies behind this light. All lights have a theory, or none has.
    pub others: Vec<Option<Self>>,
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

    /// Decides which theory applies to a plane of a scene. Theory applies to the sum of several
    /// lights if it applies to each light.
    #[must_use]
    pub fn new(scene: &Scene, plane: &VirtualPlane) -> Self {
        let first = Self::of_first_light(scene, plane);
        let others = scene.other_lights.iter().map(|other| {
            let seen = &other.planes[other.plane_named(&plane.name)?];
            Some(Self::of_first_light(other, seen))
        });
        let others: Vec<Option<Self>> = others.collect();
        if others.is_empty() {
            return first;
        }
        let each = std::iter::once(Some(&first)).chain(others.iter().map(Option::as_ref));
        let each = each.zip(1..).filter_map(|(of, number)| Some((of?, number)));
        let reasons = each.flat_map(|(of, number): (&Self, u32)| {
            let each = of.reasons.iter();
            each.map(move |reason| format!("light {number}: {reason}"))
        });
        let reasons: Vec<String> = reasons.collect();
        if reasons.is_empty() {
            return Self { others, ..first };
        }
        let others = others.into_iter();
        let others = others.map(|of| Some(of?.without_theory(Vec::new())));
        Self {
            others: others.collect(),
            ..first.without_theory(reasons)
        }
    }

    fn without_theory(self, reasons: Vec<String>) -> Self {
        Self {
            theory: Theory::None,
            reasons,
            dark: None,
            off_patches: None,
            ..self
        }
    }

    /// Decides which theory applies to the light of the first light of a scene.
    fn of_first_light(scene: &Scene, plane: &VirtualPlane) -> Self {
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
                others: Vec::new(),
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
            others: Vec::new(),
            off_patches,
        }
    }

    /// Returns the theory of each light that may reach a plane, with the scene of this light, its
    /// plane, and its number, which counts from 1.
    pub fn of_lights<'a>(
        &'a self,
        scene: &'a Scene,
        plane: &'a VirtualPlane,
    ) -> impl Iterator<Item = (&'a Scene, &'a VirtualPlane, &'a Self, usize)> {
        let others = scene.other_lights.iter().zip(&self.others).zip(2..);
        let others = others.filter_map(|((other, theory), number)| {
            let seen = &other.planes[other.plane_named(&plane.name)?];
            Some((other, seen, theory.as_ref()?, number))
        });
        std::iter::once((scene, plane, self, 1)).chain(others)
    }

    /// Returns the kind of prediction.
    #[must_use]
    pub fn class(&self) -> Class {
        let mut others = self.others.iter().flatten();
        match self.theory {
            Theory::Parallel(_) if others.any(|of| of.class() == Class::FirstOrder) => {
                Class::FirstOrder
            }
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
        let mut steps = Vec::new();
        for (of, seen, theory, number) in self.of_lights(scene, plane) {
            let own = theory.steps_of_light(of, seen);
            if scene.other_lights.is_empty() {
                steps.extend(own);
            } else {
                steps.extend(own.iter().map(|step| format!("light {number}  {step}")));
            }
        }
        let unknown = self.reasons.iter();
        steps.extend(unknown.map(|reason| format!("without theory  {reason}")));
        if !scene.other_lights.is_empty() {
            steps.push("add  the light of all lights".to_owned());
        }
        steps.push(format!(
            "multiply  by the window: x {x:?}, y {y:?}, u {u:?}, v {v:?}"
        ));
        steps
    }

    /// Describes the steps of one light before the window.
    fn steps_of_light(&self, scene: &Scene, plane: &VirtualPlane) -> Vec<String> {
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
        steps.extend(self.dark.iter().map(|reason| format!("dark  {reason}")));
        steps
    }
}
