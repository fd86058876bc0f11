//! Export of Étendue scenes to other renderers, for viewing and for checks.
//!
//! [`mitsuba`] writes a [`Scene`](etendue_scene::Scene) for [Mitsuba
//! 3](https://www.mitsuba-renderer.org): light, blockers, surfaces with their BRDFs, and beside
//! them the virtual planes, so that a script can record the same local light fields with an
//! independent tracer (`docs/mitsuba.md`). Anything Mitsuba cannot represent is refused by name.

mod mitsuba;

pub use mitsuba::{NotInMitsuba, mitsuba};

/// The files of a scene for another renderer; the same scene gives the same bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Export {
    /// File names relative to one folder, and contents.
    pub files: Vec<(String, Vec<u8>)>,
}
