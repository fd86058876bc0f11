//! Which boxes or triangles a ray may meet: the only crate that knows obvhs, and f32.
//!
//! A hierarchy, in f32, only names candidates; whether and where something is hit is decided in
//! f64 by who asks. Boxes are padded by more than rounding, so no candidate is missed. obvhs builds a tree with two boxes in a
//! node. Rays go through it as it is ([`BinaryHierarchy`]), or through one of eight (`wide`), whose leaves are a few
//! boxes, or triangles that are tried together ([`WideHierarchy`]).
//!
//! The builder panics on boxes that are no numbers. No legal scene has them, and none reach it:
//! what has no box in f32 is a candidate everywhere.

mod binary_hierarchy;
mod build;
mod collapse;
mod leaf;
mod single;
mod space;
mod wide;
mod wide_hierarchy;

pub use binary_hierarchy::BinaryHierarchy;
pub use wide_hierarchy::WideHierarchy;
