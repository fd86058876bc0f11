//! Compares two results of one scene, and describes their differences.

mod difference;
mod json;
mod planes;
mod stored;
mod text;

pub use difference::Diff;
pub use json::json;
pub use stored::no_result;
pub use text::text;
