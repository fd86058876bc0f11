//! Short Mitsuba scenes, files, and what is compared, for all tests.

#![allow(
    dead_code,
    clippy::unwrap_used,
    reason = "helpers of tests, of which each takes what it needs"
)]

use etendue_import::{Color, Imported, Options, Refused, import, import_mitsuba};
use etendue_world::{Geometry, Material, Shape, Texture, Triangles, World};
use glam::DVec3;
use std::fs;
use std::path::Path;
use std::sync::Arc;

/// A scene of version 3 with this content, which begins on line 2.
pub(crate) fn scene(inside: &str) -> String {
    format!("<scene version=\"3.0.0\">\n{inside}\n</scene>")
}

/// Imports a scene whose files are in `folder`.
pub(crate) fn read_in(inside: &str, folder: &Path, color: Color) -> Result<Imported, Vec<String>> {
    let options = Options {
        color,
        ..Options::default()
    };
    told(import_mitsuba(&scene(inside), folder, &options))
}

/// The causes of a refusal as texts.
pub(crate) fn told(read: Result<Imported, Refused>) -> Result<Imported, Vec<String>> {
    read.map_err(|refused| refused.causes.iter().map(ToString::to_string).collect())
}

/// Imports the first of several files.
pub(crate) fn read_files(files: &[(&str, &[u8])]) -> Result<Imported, Vec<String>> {
    let folder = folder(files);
    told(import(&folder.path().join(files[0].0), &Options::default()))
}

/// The world of a scene that names no files.
pub(crate) fn world(inside: &str) -> World {
    let folder = tempfile::tempdir().unwrap();
    let read = read_in(inside, folder.path(), Color::Luminance);
    read.unwrap_or_else(|causes| panic!("{causes:#?}")).world
}

/// All causes to refuse a scene without files.
pub(crate) fn causes(inside: &str) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    let read = read_in(inside, folder.path(), Color::Luminance);
    read.map(|read| read.world).unwrap_err()
}

/// All notes on a scene without files.
pub(crate) fn notes(inside: &str) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    all_notes(&read_in(inside, folder.path(), Color::Luminance).unwrap())
}

/// The notes of an import as texts.
pub(crate) fn all_notes(read: &Imported) -> Vec<String> {
    read.notes.iter().map(ToString::to_string).collect()
}

/// A folder with files.
pub(crate) fn folder(files: &[(&str, &[u8])]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
    folder
}

/// A PLY file with one triangle.
pub(crate) const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

/// A PNG picture with eight bits per level, grey or in colours.
pub(crate) fn png([width, height]: [u32; 2], levels: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(match levels.len() == (width * height) as usize {
        true => png::ColorType::Grayscale,
        false => png::ColorType::Rgb,
    });
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(levels).unwrap();
    writer.finish().unwrap();
    bytes
}

/// The value of a constant texture.
pub(crate) fn constant(texture: &Texture) -> f64 {
    match texture {
        Texture::Constant(value) => *value,
        other => panic!("{other:?}"),
    }
}

/// The mesh of a shape.
pub(crate) fn mesh(shape: &Shape) -> &Arc<Triangles> {
    match &shape.geometry {
        Geometry::Mesh(mesh) => mesh,
        other => panic!("{other:?}"),
    }
}

/// The corners of the first triangle of a mesh.
pub(crate) fn first_triangle(mesh: &Triangles) -> [DVec3; 3] {
    mesh.corners()[0].map(|i| mesh.vertices()[i as usize])
}

/// The material on the front of a material with two sides, or the material itself.
pub(crate) fn front_side(material: &Material) -> &Material {
    match material {
        Material::TwoSided(sides) => &sides[0],
        other => other,
    }
}

/// The reflectance of a diffuse material, which may have two sides.
pub(crate) fn reflectance(material: &Material) -> &Texture {
    match front_side(material) {
        Material::Diffuse { reflectance } => reflectance,
        other => panic!("{other:?}"),
    }
}

/// The cases of a table, each with a scene and what is expected of it: words of a message,
/// or numbers. `=>` separates them, on the same line or on the next one.
pub(crate) fn cases(table: &str) -> Vec<(&str, &str)> {
    let (mut all, mut open) = (Vec::new(), None);
    let lines = table.lines().map(str::trim);
    for line in lines.filter(|line| !line.is_empty()) {
        match line.split_once("=> ") {
            None => assert_eq!(open.replace(line), None, "{line}"),
            Some(("", words)) => all.push((open.take().unwrap_or_default(), words)),
            Some((scene, words)) => all.push((scene.trim_end(), words)),
        }
    }
    assert_eq!(open, None);
    all
}

/// The numbers of a text.
pub(crate) fn numbers(text: &str) -> Vec<f64> {
    let words = text.split_whitespace();
    words.map(|word| word.parse().unwrap()).collect()
}

/// Asserts that there is one cause, which contains all of the words.
pub(crate) fn assert_refused(causes: &[String], words: &[&str]) {
    assert_eq!(causes.len(), 1, "{causes:#?}");
    let has = |words: &&str| causes[0].contains(words);
    assert!(words.iter().all(has), "{causes:#?}: {words:?}");
}

/// Asserts that the first message contains the words.
pub(crate) fn assert_first(messages: &[String], words: &str) {
    assert!(messages[0].contains(words), "{messages:#?}: {words}");
}

/// Asserts that each of the texts begins a message.
pub(crate) fn assert_told(messages: &[String], texts: &[&str]) {
    for text in texts {
        let is_there = messages.iter().any(|message| message.starts_with(text));
        assert!(is_there, "{text}: {messages:#?}");
    }
}

/// Asserts that two numbers agree within `digits`.
pub(crate) fn assert_near(found: f64, expected: f64, digits: f64) {
    assert_close(&[found], &[expected], digits);
}

/// Asserts that numbers agree within `digits`, the precision of the printed reference.
pub(crate) fn assert_close(found: &[f64], expected: &[f64], digits: f64) {
    assert_eq!(found.len(), expected.len());
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() <= digits, "{found:?} is not {expected:?}");
    }
}
