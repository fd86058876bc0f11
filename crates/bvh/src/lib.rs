//! Finds the boxes or triangles that a ray may meet. Only this crate uses obvhs and f32.
//!
//! A hierarchy is in f32 and only finds candidates; the caller computes the intersections in f64.
//! Boxes are padded by more than rounding errors, so no candidate is missed. obvhs builds a tree
//! with two boxes in a node. Rays traverse this tree directly ([`BinaryHierarchy`]), or traverse
//! a tree with eight boxes in a node (`wide`). The leaves of the wide tree hold a few boxes and
//! triangles, which are tested together ([`WideHierarchy`]), or the box of one triangle
//! ([`MeshHierarchy`]).
//!
//! The builder panics on boxes with NaN. No valid scene has boxes with NaN. The builder never
//! receives such boxes, because a primitive without a box in f32 is treated as a candidate for
//! every ray.

mod binary_hierarchy;
mod build;
mod collapse;
mod leaf;
mod mesh_hierarchy;
mod parts;
mod space;
mod wide;
mod wide_hierarchy;

pub use binary_hierarchy::BinaryHierarchy;
pub use mesh_hierarchy::{MeshHierarchy, SearchMemory};
pub use wide_hierarchy::{WideHierarchy, WidePrimitive};
