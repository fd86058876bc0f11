//! Windowed spectra behind a surface that reflects by a BRDF (docs/theory.md, section 10).
//!
//! In goes a [`ScatteringSystem`]: a light, masks across its way, obstacles, and a curved surface with a BRDF that may
//! vary over it. In goes a [`Plane`](crate::rays::Plane) on the surface, light leaving it, or
//! across its way onwards. The [`Observed`](crate::Observed) of both is a [`Model`](crate::Model):
//! it sums rays of the plane over scrambled nets, and for each of them a part of the light that
//! shines on the point it leaves,
//!
//! L(p, ωo) = ∫ L(p, ωi) f(p, ωi, ωo) cos θi dωi.
//!
//! Beside it is the chain of first-order operators (Durand et al. 2005, section 4): affine maps
//! onto the surface and off it, a product with the clamped cosine, and a convolution with the lobe
//! of the BRDF that the central ray meets. What it is off, and derivatives, are sums over the same
//! rays.
//!
//! This module shares no intersection, no value of a BRDF and no sampling with the tracers; how a
//! BRDF varies over a surface is in `etendue_field`, for both.

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
pub use predict::beside;

pub(crate) use brdf::narrowest;
pub(crate) use chain::{local, reflection};
pub(crate) use draw::{bell, bell_density};
pub(crate) use linear::kernel;
pub(crate) use predict::{predict, with_rays};

use crate::obstacle::Obstacle;
use etendue_field::{Light, Mask, Patch, Reflectance};

/// A light and the surface its central ray meets, in the frame at the light.
#[derive(Clone, Debug, PartialEq)]
pub struct ScatteringSystem {
    /// What shines from the plane z = 0, along Z.
    pub light: Light,
    /// Masks between them and their distances from the light, metres.
    pub layers: Vec<(f64, Mask)>,
    /// What else stops rays, before and behind the surface.
    pub obstacles: Vec<Obstacle>,
    /// The name of the surface, for texts.
    pub name: String,
    /// The surface; it faces along D of its frame, and is black on the other side.
    pub patch: Patch,
    /// How it reflects.
    pub reflectance: Reflectance,
}
