//! Short Mitsuba scenes for all tests.

#![allow(
    dead_code,
    clippy::unwrap_used,
    reason = "helpers of tests, of which each takes what it needs"
)]

use etendue_import::{Color, Imported, Options, import_mitsuba};
use etendue_world::World;
use std::fs;
use std::path::Path;

/// Returns a scene of version 3 with this content, which begins on line 2.
pub(crate) fn scene(inside: &str) -> String {
    format!("<scene version=\"3.0.0\">\n{inside}\n</scene>")
}

/// Imports a scene whose files are in `folder`.
pub(crate) fn read_in(inside: &str, folder: &Path, color: Color) -> Result<Imported, Vec<String>> {
    let options = Options {
        color,
        ..Options::default()
    };
    let read = import_mitsuba(&scene(inside), folder, &options);
    read.map_err(|refused| refused.causes.iter().map(ToString::to_string).collect())
}

/// Returns the world of a scene that names no files.
pub(crate) fn world(inside: &str) -> World {
    let folder = tempfile::tempdir().unwrap();
    let read = read_in(inside, folder.path(), Color::Luminance);
    read.unwrap_or_else(|causes| panic!("{causes:#?}")).world
}

/// Returns all causes to refuse a scene without files.
pub(crate) fn causes(inside: &str) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    let read = read_in(inside, folder.path(), Color::Luminance);
    read.map(|read| read.world).unwrap_err()
}

/// Returns all notes on a scene without files.
pub(crate) fn notes(inside: &str) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    let read = read_in(inside, folder.path(), Color::Luminance).unwrap();
    read.notes.iter().map(ToString::to_string).collect()
}

/// Returns a folder with files.
pub(crate) fn folder(files: &[(&str, &[u8])]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
    folder
}

/// Asserts that numbers agree within `digits`, the precision of the printed reference.
pub(crate) fn assert_close(found: &[f64], expected: &[f64], digits: f64) {
    assert_eq!(found.len(), expected.len());
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() <= digits, "{found:?} is not {expected:?}");
    }
}
