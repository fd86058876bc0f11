//! Exports Étendue scenes to other renderers, for viewing and for checks.
//!
//! [`mitsuba`] writes the light, the blockers and the surfaces of a [`Scene`](etendue_scene::Scene)
//! for [Mitsuba 3](https://www.mitsuba-renderer.org). The export also holds the virtual planes.
//! With them, a script can record the same local light fields by an independent tracer
//! (`docs/mitsuba.md`). The export fails if Mitsuba cannot represent a part of the scene; the error
//! names this part.
//!
//! This crate runs no renderer and reads no results of one.

mod mitsuba;

pub use mitsuba::{NotInMitsuba, mitsuba};

/// The files of a scene for another renderer. The same scene always gives the same bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Export {
    /// File names relative to one folder, and contents.
    pub files: Vec<(String, Vec<u8>)>,
}
