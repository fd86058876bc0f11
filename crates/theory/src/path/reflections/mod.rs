//! Windowed spectra of light that several surfaces redirect in turn. Some of these surfaces scatter
//! it.
//!
//! The model of such a [path](crate::path) sums paths of light over scrambled nets. A path leaves
//! the light, is redirected by each specular surface, and leaves each scattering surface in a
//! sampled direction (docs/theory.md, section 10b):
//!
//! L(p, ωo) = ∫ L(p, ωi) f(p, ωi, ωo) cos θi dωi for each scattering surface.
//!
//! Directions are sampled from a Gaussian that guides light into the window (`guide.rs`). It is
//! computed by first-order maps, which take the window back along the path.
//!
//! The [chain](crate::path::chain()) of first-order operators (Durand et al. 2005, Table 1) has
//! affine maps from each scattering surface to the next. At each of these surfaces, it multiplies by
//! the cosine and convolves with the lobe at the central ray. Its error is computed as a sum over
//! the paths of the exact prediction.

mod aim;
mod direction;
mod guide;
mod path;
mod predict;
mod sky;
#[cfg(test)]
mod tests;

pub use predict::by_paths;

pub(crate) use predict::{predict, with_rays};

/// The maximum number of scattering surfaces before a plane. It is limited because each scattering
/// surface uses two coordinates of the nets.
pub const MAX_SCATTERERS: usize = 3;
