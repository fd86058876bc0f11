//! Windowed spectra behind a surface that reflects by a BRDF: no photons, no random numbers.
//!
//! In goes a [`System`], a light, masks across its way and a curved surface with a BRDF that may
//! vary over it, and a [`Plane`](crate::rays::Plane) on the surface, light leaving it, or across
//! its way onwards. Out come the [`exact`] slices of the windowed spectrum. The radiance of each
//! ray at the plane is an integral over what shines on the point that it leaves,
//!
//! L(p, ωo) = ∫ L(p, ωi) f(p, ωi, ωo) cos θi dωi,
//!
//! and the spectrum is a midpoint rule over the four coordinates of the plane: windows end
//! smoothly, so that it converges fast. Opaque rectangles in the way are taken out of the light one
//! by one, never met at an edge.
//!
//! Beside it is the chain of first-order operators (Durand et al. 2005, section 4): affine maps
//! onto the surface and off it, a product with the clamped cosine, and a convolution with the lobe
//! of the BRDF that the central ray meets ([`linear`]), by the same rule.
//!
//! This module shares no intersection, no BRDF, no sampling and no transform with the tracers.

mod brdf;
mod chain;
mod draw;
mod exact;
mod incoming;
mod linear;
mod parameter;
mod predict;
mod sky;
#[cfg(test)]
mod tests;

pub use chain::{Chain, chain};
pub use parameter::Parameter;
pub use predict::{Differences, Prediction, differences, predict};

use etendue_field::{Light, Mask, Patch, Reflectance};

/// A light and the surface its central ray meets, in the frame at the light.
#[derive(Clone, Debug, PartialEq)]
pub struct System {
    /// What shines from the plane z = 0, along Z.
    pub light: Light,
    /// Masks between them and their distances from the light, metres.
    pub layers: Vec<(f64, Mask)>,
    /// The name of the surface, for texts.
    pub name: String,
    /// The surface; it faces along D of its frame, and is black on the other side.
    pub patch: Patch,
    /// How it reflects.
    pub reflectance: Reflectance,
}
