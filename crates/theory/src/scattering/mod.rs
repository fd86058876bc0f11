//! Windowed spectra behind a surface that reflects by a BRDF (docs/theory.md, section 10).
//!
//! The inputs are a [`ScatteringSystem`] and a [`Plane`](crate::rays::Plane). The system has a
//! light, masks across its path, obstacles, and a curved surface with a BRDF that may vary over the
//! surface. The plane is on the surface or perpendicular to the path of light that leaves the
//! surface. A system and a plane together are an [`Observed`](crate::Observed), which is a
//! [`Model`](crate::Model). The model sums rays of the plane over scrambled nets. For each ray, the
//! model also samples a part of the light that shines on the point where the ray leaves the
//! surface:
//!
//! L(p, ωo) = ∫ L(p, ωi) f(p, ωi, ωo) cos θi dωi.
//!
//! The function [`chain`](chain()) returns the chain of first-order operators (Durand et al. 2005,
//! section 4). This chain consists of affine maps onto the surface and off the surface, a product
//! with the clamped cosine, and a convolution with the lobe of the BRDF at the central ray. The
//! error of the chain and the derivatives are computed as sums over the same rays.
//!
//! This module and the tracers share no code for intersection, BRDF evaluation or sampling. The
//! theory and the tracers share only the variation of a BRDF over a surface, in `etendue_field`.

pub mod brdf;
mod chain;
mod draw;
mod exact;
mod incoming;
mod linear;
mod model;
mod operator;
mod predict;
#[cfg(test)]
mod tests;

pub use chain::{ScatteringChain, chain, defect};
pub use operator::semi_convolution;
pub use predict::compare_chain;

pub(crate) use brdf::narrowest;
pub(crate) use chain::{local, reflection};
pub(crate) use draw::{bell, bell_density};
pub(crate) use linear::kernel;
pub(crate) use predict::{predict, with_rays};

use crate::obstacle::Obstacle;
use etendue_field::{Light, Mask, Patch, Reflectance};

/// A light and the surface that its central ray meets, in the frame at the light.
#[derive(Clone, Debug, PartialEq)]
pub struct ScatteringSystem {
    /// The light, which emits from the plane z = 0, along Z.
    pub light: Light,
    /// Masks between the light and the surface, with their distances from the light, metres.
    pub layers: Vec<(f64, Mask)>,
    /// Occluders other than the masks, on the paths before and after the surface.
    pub obstacles: Vec<Obstacle>,
    /// The name of the surface, which messages use.
    pub name: String,
    /// The shape of the surface, which faces along D of its frame and is black on the other side.
    pub patch: Patch,
    /// The reflectance of the surface.
    pub reflectance: Reflectance,
}
