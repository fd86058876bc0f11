//! Windowed spectra of light that several surfaces send on in turn, some of them by a BRDF.
//!
//! In goes a [`ReflectionSystem`]: a light, masks and obstacles anywhere, and the surfaces that the central
//! ray visits, each a mirror, a refracting surface, a lens, a diffuse rectangle or a surface with a
//! BRDF. In goes a [`Plane`](crate::rays::Plane) beyond some of them. The
//! [`Observed`](crate::Observed) of both is a [`Model`](crate::Model): it sums paths from the light
//! over scrambled nets. A path leaves the light, is turned by each specular surface, and leaves each
//! scattering surface in a direction that is drawn (docs/theory.md, section 10b):
//!
//! L(p, ωo) = ∫ L(p, ωi) f(p, ωi, ωo) cos θi dωi, one after the other.
//!
//! Directions are drawn by a Gaussian that says where light must go to come into the window
//! (`guide.rs`): the window, taken back along the path to first order.
//!
//! A path ends where it meets a surface out of turn, or one of the path a second time. So nothing
//! is taken for granted of where surfaces stand.
//!
//! Beside it is the chain of first-order operators (Durand et al. 2005, Table 1): affine maps from
//! one scattering surface to the next, and at each a product with the cosine and a convolution with
//! the lobe that the central ray meets. What it is off is a sum over the same paths.
//!
//! This module shares no intersection, no value of a BRDF and no sampling with the tracers.

mod aim;
mod chain;
mod guide;
mod model;
mod path;
mod predict;
mod surface;
#[cfg(test)]
mod tests;

pub use chain::{FirstOrderChain, chain, defect};

use crate::obstacle::Obstacle;
use etendue_field::{Light, Patch, Reflectance, Specular};
use glam::DVec3;

/// The most scattering surfaces before a plane: each takes two coordinates of the nets.
pub const MAX_SCATTERERS: usize = 3;

/// A light and the surfaces of its path, in the frame at the light.
#[derive(Clone, Debug, PartialEq)]
pub struct ReflectionSystem {
    /// What shines from the plane z = 0, along Z; neither an environment nor a ray file.
    pub light: Light,
    /// Masks, and whatever else stands in the way and is not on the path.
    pub obstacles: Vec<Obstacle>,
    /// All surfaces of the path, in the order of light.
    pub surfaces: Vec<PathSurface>,
    /// How many of them light has left before the plane. The next one, if any, ends the last leg and
    /// hides nothing of it.
    pub visited: usize,
}

/// A surface of the path.
#[derive(Clone, Debug, PartialEq)]
pub struct PathSurface {
    /// Its name, for texts.
    pub name: String,
    /// Where it is.
    pub patch: Patch,
    /// Side lengths along X and Y, metres, of a rectangle that lies in the patch; `None` for all of
    /// the patch.
    pub outline: Option<[f64; 2]>,
    /// Where the central ray meets it.
    pub hit: DVec3,
    /// What it does to light.
    pub interaction: Interaction,
}

/// What a surface does to light.
#[derive(Clone, Debug, PartialEq)]
pub enum Interaction {
    /// It sends each ray on in one direction.
    Specular(Specular),
    /// It reflects by a BRDF on the side it faces, and is black on the other.
    Reflects(Box<Reflectance>),
    /// It reflects diffusely on both sides.
    Diffuse {
        /// Reflected over incident flux.
        albedo: f64,
    },
}
