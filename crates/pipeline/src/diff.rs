//! Two results of one scene held against each other: what differs, and the words for it.

mod difference;
mod planes;
mod stored;
mod text;

pub use difference::Diff;
pub use text::text;
