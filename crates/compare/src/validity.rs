//! Whether light takes the ways that theory takes it to take.
//!
//! Theory follows rays from surface to surface as if nothing else were there. A few thousand rays
//! with light in the window, the same in every run, are followed here past all that stands around:
//! to what they meet first, as photons are, and to where theory looks for the next surface. Where
//! the two differ, the plane is not predicted. Rays are drawn more densely the nearer they are to
//! the central one, down to a thousandth of the surface, so that windows of any size hold many.

mod clearance;
mod coordinates;
mod mesh_error;
mod meshes;
mod rays;
mod scattered;
mod search;
mod specular;
mod surroundings;

pub use mesh_error::OffPatches;
pub(crate) use scattered::unforeseen_by_scattering;
pub(crate) use specular::{off_patches, unforeseen_by_rays};
