//! Scenes of Étendue for other renderers, to look at and to check against.
//!
//! [`mitsuba`] writes a [`Scene`](etendue_scene::Scene) for [Mitsuba 3](https://www.mitsuba-renderer.org): light,
//! blockers, surfaces with what they do to light, and beside them the virtual planes, so that a script can record the same local light
//! fields with a tracer that shares nothing with ours (`docs/mitsuba.md`). What Mitsuba cannot say is refused by name.

mod mitsuba;

pub use mitsuba::{NotInMitsuba, mitsuba};

/// The files of a scene for another renderer; the same scene gives the same bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Export {
    /// Name relative to one folder, and content.
    pub files: Vec<(String, Vec<u8>)>,
}
