//! Which theory applies to a plane, decided once.

use crate::chain::chain;
use crate::class::Class;
use crate::dark;
use crate::parallel::obstacles_to_theory;
use crate::system::{in_the_way, print, reflected, scattered, system, too_fine};
use crate::ways::{OffPatches, off_patches, unforeseen_by_rays, unforeseen_by_scattering};
use etendue_field::{Mask, Orientation, Side, VirtualPlane, Window};
use etendue_scene::{BlockerLayer, Scene};
use etendue_theory::{
    Budget, Chain, Model, Observed, Over, Parameter, Work, rays, reflections, scattering,
};

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

/// The theories of a windowed light field.
#[derive(Clone, Debug)]
pub enum Theory {
    /// Light between parallel planes, in closed form or by quadrature over a flat receiver.
    Parallel(Chain),
    /// Rays followed through smooth specular surfaces, or through pictures.
    Specular(Box<Observed<rays::System>>),
    /// Light that one smooth surface reflects by a BRDF.
    Scattering(Box<Observed<scattering::System>>),
    /// Light that several surfaces send on in turn, or one past its own shadow or its edges.
    Reflections(Box<Observed<reflections::System>>),
    /// None: another measurement takes its place.
    None,
}

impl Theory {
    /// The theory that has words for what the central ray meets on its way to a plane, whether or
    /// not what it takes for granted is so.
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

    /// Whether all light meets blockers before it comes to a surface.
    pub(crate) fn has_all_light_meet(&self, layer: &BlockerLayer) -> bool {
        let layers = match self {
            Self::Specular(view) => &view.system.layers,
            Self::Scattering(view) => &view.system.layers,
            Self::Reflections(_) => return false,
            Self::Parallel(_) | Self::None => return true,
        };
        layers.iter().any(|known| is_same(known, layer))
    }

    /// What the theory takes for granted of a scene, each checked where it applies.
    #[must_use]
    pub fn assumptions(&self) -> &'static [&'static str] {
        const FOLLOWED: &[&str] = &["light meets each surface once, in the order of the path, \
             and where it is not in its own shadow"];
        match self {
            Self::Parallel(_) => &[
                "all that light meets lies in planes across the path",
                "the receiver has no edge in view",
            ],
            Self::Specular(_) | Self::Scattering(_) => FOLLOWED,
            Self::Reflections(_) | Self::None => &[],
        }
    }

    /// The numbers of its model that a measurement may be asked for.
    pub(crate) fn parameters(&self) -> Vec<Parameter> {
        match self {
            Self::Parallel(chain) => chain.parameters(),
            Self::Specular(view) => view.parameters(),
            Self::Scattering(view) => view.parameters(),
            Self::Reflections(view) => view.parameters(),
            Self::None => Vec::new(),
        }
    }

    /// What a prediction of its model takes.
    pub(crate) fn work(&self, over: Over<'_>, budget: Budget) -> Work {
        match self {
            Self::Parallel(chain) => chain.work(over, budget),
            Self::Specular(view) => view.work(over, budget),
            Self::Scattering(view) => view.work(over, budget),
            Self::Reflections(view) => view.work(over, budget),
            Self::None => Work::none(),
        }
    }
}

fn is_same((distance, mask): &(f64, Mask), layer: &BlockerLayer) -> bool {
    distance.total_cmp(&layer.distance).is_eq() && *mask == layer.mask
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
        let dark = dark::reason(scene, plane, &theory);
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

/// The system of specular surfaces that leads to a plane behind one or on one, or of light that
/// goes through pictures.
fn followed(scene: &Scene, plane: &VirtualPlane) -> Option<Observed<rays::System>> {
    let across = plane.orientation == Orientation::Orthogonal;
    if !scene.light.is_picture() && plane.leg == 0 && across {
        return None;
    }
    system(scene, plane)
}
