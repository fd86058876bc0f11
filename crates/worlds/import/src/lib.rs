//! Reads scenes of other programs into a [`World`](etendue_world::World).
//!
//! Supported formats are the XML of Mitsuba 3, the files of pbrt-v4, glTF 2.0 (JSON or binary), OBJ
//! with MTL, and PLY. Content that a world cannot represent is a *cause of refusal*. A scene is
//! refused with all causes at once. Minor omissions and approximations are *notes*. No content of a
//! scene is dropped without a message.

mod cie;
mod files;
mod gltf;
mod main_file;
mod meshes;
mod mitsuba;
mod obj;
mod pbrt;
mod pictures;
mod range;
mod report;
mod spectrum;

pub use etendue_scene::Color;
pub use main_file::Options;
pub use report::{Imported, Note, Refused};

use main_file::MainFile;
use std::path::Path;

/// Reads a scene file. The extension of the file, in upper or lower case, determines the format:
///
/// * `xml`: Mitsuba 3.
/// * `pbrt`: pbrt-v4.
/// * `gltf`, `glb`: glTF 2.0. Coordinates are right-handed with Y up, and cameras look along −Z.
///   The cameras do not state a number of pixels, so pictures are 512 pixels wide. The numbers of
///   lights are taken as radiometric: 1 cd as 1 W/sr, 1 lx as 1 W/m², 1 nit as 1 W m⁻² sr⁻¹.
///   Surfaces that are not `doubleSided` are black on their back.
/// * `obj`: surfaces with the materials of MTL files, which scatter on both sides and emit `Ke` as
///   radiance on their front. There is no camera.
/// * `ply`: one diffuse surface with reflectance 0.5 on both sides. There is no camera.
///
/// # Errors
/// Returns all causes for which the file cannot be imported.
pub fn import(file: &Path, options: &Options) -> Result<Imported, Refused> {
    const ALLOWED: &str = "gltf, glb (glTF 2.0), obj, ply, pbrt (pbrt-v4), xml (Mitsuba 3)";
    let extension = file.extension().unwrap_or_default().to_string_lossy();
    let message = match extension.to_ascii_lowercase().as_str() {
        "gltf" | "glb" => return gltf::import(file, options),
        "obj" => return obj::import(file, options),
        "ply" => return obj::import_ply(file, options),
        "xml" => return mitsuba::import(file, options),
        "pbrt" => return pbrt::import(file, options),
        "ron" | "json" => {
            format!("a scene of Étendue: use run or check for it. Allowed here: {ALLOWED}")
        }
        other => format!("extension {other:?}; allowed: {ALLOWED}"),
    };
    Err(Refused::because(file, message))
}

/// Reads the text of a Mitsuba 3 scene; files are searched for from `folder`.
///
/// # Errors
/// Returns all causes for which the text cannot be imported.
pub fn import_mitsuba(text: &str, folder: &Path, options: &Options) -> Result<Imported, Refused> {
    let file = MainFile::of_text(folder, "text.xml", options)?;
    mitsuba::read(text.to_owned(), file)
}

/// Reads the text of a pbrt-v4 scene; files are searched for from `folder`.
///
/// # Errors
/// Returns all causes for which the text cannot be imported.
pub fn import_pbrt(text: &str, folder: &Path, options: &Options) -> Result<Imported, Refused> {
    pbrt::read(text, MainFile::of_text(folder, "text.pbrt", options)?)
}
