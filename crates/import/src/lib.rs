//! Scenes of other programs, read as a [`World`](etendue_world::World).
//!
//! So far Mitsuba 3's XML. What a world cannot hold is a cause, and the scene is refused with all of them at once; what makes little difference,
//! or is approximated, is a note. Nothing is dropped in silence.

mod cie;
mod files;
mod gltf;
mod meshes;
mod mitsuba;
mod note;
mod options;
mod pictures;
mod report;
mod spectrum;

pub use note::{Imported, Note, Refused};
pub use options::{Color, Options};

use std::path::Path;

/// Reads a scene file, its format told by its extension in any case: `xml` for Mitsuba 3.
///
/// # Errors
/// All causes why the file makes no world.
pub fn import(file: &Path, options: &Options) -> Result<Imported, Refused> {
    let extension = file.extension().unwrap_or_default().to_string_lossy();
    match extension.to_ascii_lowercase().as_str() {
        "gltf" | "glb" => gltf::import(file, options),
        "xml" => mitsuba::import(file, options),
        other => Err(Refused::because(
            file,
            format!("extension {other:?}; allowed: xml (Mitsuba 3)"),
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
