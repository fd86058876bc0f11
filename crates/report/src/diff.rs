//! Compares two results of one scene, or of two scenes with the same random numbers, and describes
//! their differences.

mod difference;
mod json;
mod pairs;
mod picture;
mod planes;
mod radial;
mod stored;
mod text;

pub use difference::Diff;
pub use json::json;
pub use text::text;
