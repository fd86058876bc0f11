//! Scenes of other programs, read as a [`World`](etendue_world::World).
//!
//! Mitsuba 3's XML, and pbrt-v4's files. What a world cannot hold is a cause, and the scene is refused with all of them at once; what makes little difference,
//! or is approximated, is a note. Nothing is dropped in silence.

mod cie;
mod files;
mod meshes;
mod mitsuba;
mod note;
mod options;
mod pbrt;
mod pictures;
mod placement;
mod report;
mod spectrum;

pub use note::{Imported, Note, Refused};
pub use options::{Color, Options};

use std::path::Path;

/// Reads a scene file, its format told by its extension in any case: `xml` for Mitsuba 3, `pbrt` for pbrt-v4.
///
/// # Errors
/// All causes why the file makes no world.
pub fn import(file: &Path, options: &Options) -> Result<Imported, Refused> {
    let extension = file.extension().unwrap_or_default().to_string_lossy();
    match extension.to_ascii_lowercase().as_str() {
        "xml" => mitsuba::import(file, options),
        "pbrt" => pbrt::import(file, options),
        other => Err(Refused::because(
            file,
            format!("extension {other:?}; allowed: xml (Mitsuba 3), pbrt (pbrt-v4)"),
        )),
    }
}

/// Reads the text of a Mitsuba 3 scene; files that it names are looked for from `folder`.
///
/// # Errors
/// All causes why the text makes no world.
pub fn import_mitsuba(text: &str, folder: &Path, options: &Options) -> Result<Imported, Refused> {
    mitsuba::import_text(text, folder, options)
}

/// Reads the text of a pbrt-v4 scene; files that it names are looked for from `folder`.
///
/// # Errors
/// All causes why the text makes no world.
pub fn import_pbrt(text: &str, folder: &Path, options: &Options) -> Result<Imported, Refused> {
    pbrt::import_text(text, folder, options)
}
