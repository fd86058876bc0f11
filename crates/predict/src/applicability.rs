//! Decides, once for each plane, which theory applies.

use crate::chain::chain;
use crate::off_parallel::obstacles_to_theory;
use crate::off_patches::{OffPatches, off_patches};
use crate::theories::Theory;
use crate::theory_input::{path, print, too_fine};
use crate::unlit;
use etendue_compare::Class;
use etendue_field::{VirtualPlane, Window};
use etendue_scene::Scene;
use etendue_theory::path::rays;
use etendue_theory::{ChainStep, Observed, PathKind};

/// The theory that applies to a plane, or the reasons why none does.
#[derive(Clone, Debug)]
pub struct Applicability {
    /// The theory, with the facts of the scene that it needs.
    pub theory: Theory,
    /// The reasons why no theory applies. The list is empty where a theory applies.
    pub reasons: Vec<String>,
    /// The reasons why the theory of a path replaces the theory of parallel planes. The list is empty
    /// where it is not replaced.
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

    /// Decides which theory applies to the light of the first light of a scene. Where light does
    /// not stay between parallel planes, the theory of its path applies instead, because it tests
    /// every ray against all objects.
    fn of_first_light(scene: &Scene, plane: &VirtualPlane) -> Self {
        let view = path(scene, plane);
        let mut theory = Theory::first(scene, plane, view.as_ref());
        let (mut reasons, mut declined) = (Vec::new(), Vec::new());
        if let Theory::Parallel(_) = theory {
            reasons = obstacles_to_theory(scene, plane);
        }
        let fine = too_fine(scene);
        if let (false, true, Some(view)) = (reasons.is_empty(), fine.is_empty(), view) {
            declined = std::mem::take(&mut reasons);
            theory = Theory::Path(Box::new(view));
        }
        let specular = theory.path_of(PathKind::Specular);
        let off_patches = specular.and_then(|view| off_patches(scene, plane, view));
        reasons.extend(off_patches.and_then(|off| off.reason()));
        if theory.path().is_some() {
            reasons.extend(fine);
        }
        let found = Self {
            dark: None,
            theory,
            reasons,
            declined,
            others: Vec::new(),
            off_patches,
        };
        if found.reasons.is_empty() {
            let dark = unlit::reason(scene, plane, &found.theory);
            Self { dark, ..found }
        } else {
            let reasons = found.reasons.clone();
            found.without_theory(reasons)
        }
    }

    /// The theory of each light that may reach a plane, with the scene of this light, its
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

    /// The kind of prediction.
    #[must_use]
    pub fn class(&self) -> Class {
        let mut others = self.others.iter().flatten();
        match self.theory {
            Theory::Parallel(_) if others.any(|of| of.class() == Class::FirstOrder) => {
                Class::FirstOrder
            }
            Theory::Parallel(_) => Class::Exact,
            Theory::Path(_) => Class::FirstOrder,
            Theory::None => Class::Reference,
        }
    }

    /// The chain of affine maps that leads to a plane behind specular surfaces. The chain
    /// uses the paper's printed formulas where the scene asks for these formulas.
    #[must_use]
    pub fn affine_chain(&self, scene: &Scene) -> Option<rays::AffineChain> {
        rays::chain(self.theory.path_of(PathKind::Specular)?, print(scene))
    }

    /// The steps after the light, of the chain to a plane that only the first light reaches by
    /// parallel planes or specular surfaces. Returns `None` for any other plane.
    #[must_use]
    pub fn chain_steps(&self, scene: &Scene, plane: &VirtualPlane) -> Option<Vec<ChainStep>> {
        match &self.theory {
            _ if !scene.other_lights.is_empty() => None,
            Theory::Parallel(_) => Some(chain(scene, plane).steps()),
            Theory::Path(_) => Some(self.affine_chain(scene)?.steps),
            Theory::None => None,
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
            Theory::Path(view) => Some(self.maps(scene, view).unwrap_or_default()),
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

    /// Describes the maps of the first-order chain along a path.
    fn maps(&self, scene: &Scene, view: &Observed) -> Option<Vec<String>> {
        if view.kind() == PathKind::Specular {
            let steps = self.affine_chain(scene)?.steps;
            return Some(steps.into_iter().map(|step| step.words).collect());
        }
        Some(etendue_theory::path::chain(view)?.steps)
    }
}
