//! Windowed spectra of light that several surfaces reflect in turn. Some of these surfaces have a
//! BRDF.
//!
//! The inputs are a [`ReflectionSystem`] and a [`Plane`](crate::rays::Plane) beyond some of its
//! surfaces. The system has a light, masks and obstacles anywhere, and the surfaces that the
//! central ray visits. Each surface is a mirror, a refracting surface, a lens, a diffuse rectangle
//! or a surface with a BRDF. A system and a plane together are an [`Observed`](crate::Observed), a
//! [`Model`](crate::Model) that sums paths from the light over scrambled nets. A path leaves the
//! light, is redirected by each specular surface, and leaves each scattering surface in a sampled
//! direction (docs/theory.md, section 10b):
//!
//! L(p, ωo) = ∫ L(p, ωi) f(p, ωi, ωo) cos θi dωi for each scattering surface.
//!
//! Directions are sampled from a Gaussian that guides light into the window (`guide.rs`). It is
//! computed by first-order maps, which take the window back along the path.
//!
//! A path ends if it meets a surface out of order, or if it meets a surface for a second time. The
//! surfaces may therefore have any positions.
//!
//! The module also has the chain of first-order operators (Durand et al. 2005, Table 1). The chain
//! has affine maps from each scattering surface to the next. At each of these surfaces, the chain
//! multiplies by the cosine and convolves with the lobe at the central ray. The error of the chain
//! is computed as a sum over the paths of the exact prediction.
//!
//! This module shares no intersection, BRDF evaluation or sampling code with the tracers.

mod aim;
mod chain;
mod direction;
mod guide;
mod model;
mod path;
mod predict;
mod sky;
mod surface;
#[cfg(test)]
mod tests;

pub use chain::{ReflectionChain, chain, defect};

use crate::obstacle::Obstacle;
use etendue_field::{Light, Patch, Reflectance, Specular};
use glam::DVec3;

/// The maximum number of scattering surfaces before a plane. It is limited because each scattering
/// surface uses two coordinates of the nets.
pub const MAX_SCATTERERS: usize = 3;

/// A light and the surfaces of its path, in the frame at the light.
#[derive(Clone, Debug, PartialEq)]
pub struct ReflectionSystem {
    /// The light, which emits from the plane z = 0, along Z. A light that is a list of rays is not
    /// allowed.
    pub light: Light,
    /// Masks and other occluders that are not on the path.
    pub obstacles: Vec<Obstacle>,
    /// All surfaces of the path, in the order in which light meets them.
    pub surfaces: Vec<PathSurface>,
    /// The number of surfaces that light has left before the plane. The next surface, if any, ends
    /// the last leg and does not occlude light on this leg.
    pub visited: usize,
}

/// A surface of the path.
#[derive(Clone, Debug, PartialEq)]
pub struct PathSurface {
    /// The name of the surface, which messages use.
    pub name: String,
    /// The geometry of the surface.
    pub patch: Patch,
    /// The side lengths along X and Y, metres, if the surface is a rectangle in the patch. `None`
    /// stands for the whole patch.
    pub outline: Option<[f64; 2]>,
    /// The point where the central ray meets the surface.
    pub hit: DVec3,
    /// The interaction of light with the surface.
    pub interaction: Interaction,
}

/// The interaction of light with a surface.
#[derive(Clone, Debug, PartialEq)]
pub enum Interaction {
    /// A specular event, after which each ray continues in one direction.
    Specular(Specular),
    /// Reflection by a BRDF on the side that the surface faces; the other side is black.
    Reflects(Box<Reflectance>),
    /// Diffuse reflection on both sides.
    Diffuse {
        /// The ratio of reflected to incident flux.
        albedo: f64,
    },
}
