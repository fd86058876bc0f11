//! Checks whether light follows the paths that theory assumes.
//!
//! Theory follows rays from surface to surface and ignores all other objects. This module traces a
//! few thousand rays that bring light into the window. These rays are the same in every run. The
//! module traces each ray twice: as a photon, to the first object in the whole scene, and as theory
//! does, to the next surface of the path. If the two results differ, the plane is not predicted.
//! Rays are drawn more densely near the central ray, down to distances of a thousandth of the
//! surface, so that a window of any size receives many rays.

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
