//! Short pbrt-v4 scenes for all tests.

#![allow(
    dead_code,
    clippy::unwrap_used,
    reason = "helpers of tests, of which each takes what it needs"
)]

use crate::common::{all_notes, front_side, told};
use etendue_import::{Color, Imported, Options, import_pbrt};
use etendue_world::{Light, Material, Shape, World};
use std::path::Path;

/// A scene with the text `before` ahead of `WorldBegin`, and `inside` after it, on line 3.
pub(crate) fn scene(before: &str, inside: &str) -> String {
    format!("PixelFilter \"box\" {before}\nWorldBegin\n{inside}\n")
}

/// Imports a scene whose files are in `folder`.
pub(crate) fn read_in(text: &str, folder: &Path, color: Color) -> Result<Imported, Vec<String>> {
    let options = Options {
        color,
        ..Options::default()
    };
    told(import_pbrt(text, folder, &options))
}

fn read(text: &str) -> Result<Imported, Vec<String>> {
    let folder = tempfile::tempdir().unwrap();
    read_in(text, folder.path(), Color::Luminance)
}

/// The world of a scene that names no files.
pub(crate) fn world(inside: &str) -> World {
    read(&scene("", inside))
        .unwrap_or_else(|causes| panic!("{causes:#?}"))
        .world
}

/// The world of a scene with settings only.
pub(crate) fn set_up(before: &str) -> World {
    read(&scene(before, ""))
        .unwrap_or_else(|causes| panic!("{causes:#?}"))
        .world
}

/// All causes to refuse a scene without files.
pub(crate) fn causes(inside: &str) -> Vec<String> {
    read(&scene("", inside)).map(|read| read.world).unwrap_err()
}

/// All causes to refuse settings.
pub(crate) fn unsettled(before: &str) -> Vec<String> {
    read(&scene(before, "")).map(|read| read.world).unwrap_err()
}

/// All notes on a scene without files.
pub(crate) fn notes(inside: &str) -> Vec<String> {
    all_notes(&read(&scene("", inside)).unwrap())
}

pub(crate) fn shape(inside: &str) -> Shape {
    world(inside).shapes.remove(0)
}

pub(crate) fn light(inside: &str) -> Light {
    world(inside).lights.remove(0)
}

/// The material of a sphere or, if the material has two equal sides, the material of one
/// side.
pub(crate) fn material(declared: &str) -> Material {
    let world = world(&format!("{declared}\nShape \"sphere\""));
    front_side(&world.materials[world.shapes[0].material]).clone()
}
