//! Windowed spectra behind a surface that reflects by a BRDF (docs/theory.md, section 10).
//!
//! The only surface that light leaves before the plane has a BRDF, which may vary over the surface.
//! The plane is on the surface or perpendicular to the path of light that leaves the surface. The
//! model of such a [path](crate::path) sums rays of the plane over scrambled nets. For each ray, the
//! model also samples a part of the light that shines on the point where the ray leaves the
//! surface:
//!
//! L(p, ωo) = ∫ L(p, ωi) f(p, ωi, ωo) cos θi dωi.
//!
//! The [chain](crate::path::chain()) of first-order operators (Durand et al. 2005, section 4)
//! consists of affine maps onto the surface and off the surface, a product with the clamped cosine,
//! and a convolution with the lobe of the BRDF at the central ray. The error of the chain and the
//! derivatives are computed as sums over the same rays.
//!
//! This module and the tracers share no code for intersection, BRDF evaluation or sampling. The
//! theory and the tracers share only the variation of a BRDF over a surface, in `etendue_field`.

pub mod brdf;
mod draw;
mod exact;
mod incoming;
mod linear;
mod predict;
#[cfg(test)]
mod tests;

pub use predict::compare_chain;

pub(crate) use brdf::narrowest;
pub(crate) use draw::{bell, bell_density};
pub(crate) use linear::kernel;
pub(crate) use predict::{predict, with_rays};

use crate::geometry::AffineMap;
use crate::path::PathChain;

/// The map from coordinates of the plane to local coordinates, at the surface, of the
/// direction in which a ray leaves.
fn back(chain: &PathChain) -> Option<AffineMap<4>> {
    let mut back = chain.maps[1].inverse()?;
    // The chain's angles are relative to the central ray.
    for (offset, angle) in back.offset[2..]
        .iter_mut()
        .zip(chain.scatterers[0].outgoing)
    {
        *offset += angle;
    }
    Some(back)
}
