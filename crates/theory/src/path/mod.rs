//! A light and the surfaces that its central ray visits, and the model of its light at a plane.
//!
//! The inputs are a [`PathSystem`] and a [`Plane`]. The system has a light, masks, obstacles beside
//! the path, and the surfaces that the central ray visits, in their order. Each surface is a
//! mirror, a refracting surface, a lens, a diffuse rectangle or a surface with a BRDF. A system and
//! a plane together are an [`Observed`], which is a [`Model`](crate::Model).
//!
//! Light follows the path if it meets the next surface first on each leg. Masks attenuate it, and
//! everything else stops it. Every ray is tested for this (`prepared.rs`), so the surfaces may have
//! any positions. Like a photon, a ray is lost where it meets a surface out of order or twice.
//!
//! The model samples rays in one of three ways, which [`PathKind`] names. They share the system, its
//! occluders, its parameters and its plane: [`rays`] follows rays through specular
//! surfaces, [`scattering`] follows rays of the plane back to one surface with a
//! BRDF, and [`reflections`] follows rays from the light over several surfaces.
//!
//! The theory of a path shares no intersection, BRDF evaluation or sampling code with the tracers.

mod chain;
mod differences;
mod model;
mod prepared;
pub mod rays;
pub mod reflections;
pub mod scattering;
mod shrunk;
mod surface;

pub use chain::{PathChain, ScatteringSurface, chain, defect};

pub(crate) use chain::{local, towards};
pub(crate) use prepared::{AtMask, MaskCrossings, PreparedPath, SAME_DISTANCE};

use crate::obstacle::Obstacle;
use crate::plane::Plane;
use etendue_field::{Light, Mask, Patch, Reflectance, Specular};
use glam::DVec3;

/// A light and the surfaces of its path, in the frame at the light.
#[derive(Clone, Debug, PartialEq)]
pub struct PathSystem {
    /// The light, which emits from the plane z = 0, along Z. A light that is a list of rays is not
    /// allowed.
    pub light: Light,
    /// Masks in planes across the first leg, in ascending order of distance. A mask attenuates
    /// light on every leg that crosses it. It may stand behind the light, at a negative distance,
    /// or beyond the first surface.
    pub masks: Vec<PathMask>,
    /// Occluders beside the path.
    pub obstacles: Vec<Obstacle>,
    /// All surfaces of the path, in the order in which light meets them.
    pub surfaces: Vec<PathSurface>,
    /// The number of surfaces that light has left before the plane. The next surface, if any, ends
    /// the last leg and does not occlude light on this leg.
    pub visited: usize,
}

/// A mask in a plane across the first leg.
#[derive(Clone, Debug, PartialEq)]
pub struct PathMask {
    /// The name of the mask, which messages use.
    pub name: String,
    /// The distance from the light, in metres.
    pub distance: f64,
    /// What passes the plane.
    pub mask: Mask,
}

/// A surface of the path.
#[derive(Clone, Debug, PartialEq)]
pub struct PathSurface {
    /// The name of the surface, which messages use.
    pub name: String,
    /// The geometry of the surface.
    pub patch: Patch,
    /// The extent of the surface in its patch.
    pub extent: PatchExtent,
    /// The point where the central ray meets the surface.
    pub hit: DVec3,
    /// The interaction of light with the surface.
    pub interaction: Interaction,
    /// Whether the surface stops light that it does not deflect. A patch that osculates a mesh does
    /// not, because the mesh is not known far from the central ray's hit.
    pub occludes: bool,
}

/// The extent of a surface in its patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PatchExtent {
    /// The whole patch.
    Whole,
    /// The rectangle around the patch's vertex with these side lengths along X and Y, metres.
    Rectangle([f64; 2]),
}

/// The interaction of light with a surface.
#[derive(Clone, Debug, PartialEq)]
pub enum Interaction {
    /// A specular event, after which each ray continues in one direction. A refracted ray goes from
    /// the side of the incident ray to the other side of the surface. A thin lens is flat. Slopes
    /// at a lens are relative to X and Y of the patch's frame and to the normal on the side to which
    /// light goes.
    Specular(Specular),
    /// Reflection by a BRDF on the side that the surface faces; the other side is black.
    Reflects(Box<Reflectance>),
    /// Diffuse reflection on both sides.
    Diffuse {
        /// The ratio of reflected to incident flux.
        albedo: f64,
    },
}

/// The light of a path, observed at a plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Observed {
    /// The light and the surfaces on its path.
    pub system: PathSystem,
    /// The plane at which the light is observed.
    pub plane: Plane,
}

/// The way to sample the rays of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathKind {
    /// No surface scatters the light before the plane. Rays are followed from the light, or back
    /// from the plane.
    Specular,
    /// One surface with a BRDF is all that light leaves before the plane. Rays are followed back
    /// from the plane.
    Scattered,
    /// Several surfaces redirect the light, and some of them scatter it, or a diffuse rectangle
    /// does. Paths are followed from the light, guided into the window.
    Several,
}

impl PathSystem {
    /// The system of a light and surfaces, all of which light leaves before the plane. The
    /// system has no masks and no obstacles.
    #[must_use]
    pub fn new(light: Light, surfaces: Vec<PathSurface>) -> Self {
        Self {
            light,
            masks: Vec::new(),
            obstacles: Vec::new(),
            visited: surfaces.len(),
            surfaces,
        }
    }

    /// The surfaces that light leaves before the plane.
    #[must_use]
    pub fn before_plane(&self) -> &[PathSurface] {
        &self.surfaces[..self.visited]
    }

    /// The masks that the central ray crosses on its first leg of the given length.
    pub fn masks_before(&self, length: f64) -> impl DoubleEndedIterator<Item = &PathMask> {
        let masks = self.masks.iter();
        masks.filter(move |mask| 0.0 < mask.distance && mask.distance < length)
    }

    /// The number of surfaces that scatter light before the plane.
    #[must_use]
    pub fn scatterers(&self) -> usize {
        let visited = self.before_plane().iter();
        visited.filter(|surface| surface.scatters()).count()
    }

    /// The patch and the reflectance of the first surface, which has a BRDF if the path is of
    /// the kind [`PathKind::Scattered`].
    ///
    /// # Panics
    /// Panics if the first surface has no BRDF.
    #[must_use]
    pub fn scatterer(&self) -> (&Patch, &Reflectance) {
        let PathSurface {
            patch, interaction, ..
        } = &self.surfaces[0];
        match interaction {
            Interaction::Reflects(reflectance) => (patch, reflectance),
            _ => panic!("the first surface has no BRDF"),
        }
    }
}

impl PathSurface {
    /// A surface that is the whole of a patch. The central ray meets it at the vertex.
    #[must_use]
    pub fn new(name: &str, patch: Patch, interaction: Interaction) -> Self {
        Self {
            name: name.to_owned(),
            patch,
            extent: PatchExtent::Whole,
            hit: patch.frame.origin,
            interaction,
            occludes: true,
        }
    }
}

impl Observed {
    /// The way in which rays of the path are sampled.
    #[must_use]
    pub fn kind(&self) -> PathKind {
        let visited = self.system.before_plane();
        // A plane on the next surface has the coordinates of that surface, to which rays are not
        // followed back.
        let is_on_next = self.plane.is_arriving();
        match visited {
            _ if self.system.scatterers() == 0 => PathKind::Specular,
            [only] if !is_on_next && matches!(only.interaction, Interaction::Reflects(_)) => {
                PathKind::Scattered
            }
            _ => PathKind::Several,
        }
    }
}
