//! Tests that the scenes shown in the book can be read.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use etendue_scene::SceneFile;
use std::fs;
use std::path::Path;

/// A small valid scene, given field by field.
const FIELDS: [(&str, &str); 5] = [
    ("light", "light: Point(center: (0, 0, 0))"),
    (
        "path",
        "path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: [])",
    ),
    ("planes", "planes: []"),
    ("window", "window: (x: Hann(0.5), u: Hann(0.5))"),
    ("frequencies", "frequencies: (rho: (max: 8), nu: (max: 8))"),
];

/// The fragments of scene files on a page of the book; each fragment begins a line.
fn fragments(page: &str) -> Vec<String> {
    let blocks = page.split("```ron fragment\n").skip(1);
    let mut fields: Vec<String> = Vec::new();
    for line in blocks.flat_map(|block| block.split("```").next().unwrap().lines()) {
        match line.starts_with(char::is_lowercase) {
            true => fields.push(line.to_owned()),
            false => *fields.last_mut().unwrap() += &format!("\n{line}"),
        }
    }
    fields
}

#[test]
fn fragments_of_scenes_are_parts_of_scenes() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/scenes.md");
    let fields = fragments(&fs::read_to_string(page).unwrap());
    for field in &fields {
        let (name, _) = field.split_once(':').unwrap();
        let others = FIELDS.iter().filter(|(other, _)| *other != name);
        let others: Vec<&str> = others.map(|(_, text)| *text).collect();
        let scene = format!("({},\n{field}\n)", others.join(",\n"));
        let read = SceneFile::parse(&scene);
        assert!(read.is_ok(), "{field}: {}", read.unwrap_err());
    }
    assert!(fields.len() > 10, "{} fragments", fields.len());
}
