//! Tests scene files in JSON: as stored in results, and as editors check them with the schema.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use etendue_scene::{SceneFile, resolve};
use std::fs;
use std::path::{Path, PathBuf};

/// The scenes of this repository.
fn scenes() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let below = ["table1", "wild", "words"].map(|name| folder.join(name));
    let folders = below.iter().chain([&folder]);
    let files = folders.flat_map(|folder| fs::read_dir(folder).unwrap());
    let paths = files.map(|entry| entry.unwrap().path());
    paths
        .filter(|path| path.extension().is_some_and(|e| e == "ron"))
        .collect()
}

#[test]
fn scenes_are_the_same_in_json() {
    for path in scenes() {
        let ron = SceneFile::parse(&fs::read_to_string(&path).unwrap()).unwrap();
        let json = serde_json::to_string_pretty(&ron).unwrap();
        assert_eq!(SceneFile::parse(&json).unwrap(), ron, "{}", path.display());
    }
}

#[test]
fn faults_in_json_are_named_with_their_line() {
    let text = r#"{
  "light": {"Rectangle": {"center": [0, 0, 0], "size": [0.2, 0.2]}},
  "surfaces": [{"Rectangle": {"name": "floor", "center": [0, 0, 2], "size": [4, 4]}}],
  "path": {"direction": [0, 0, 1], "x_axis": [1, 0, 0], "visits": ["floor"]},
  "planes": [{"name": "floor", "at": {"Before": "floor"}}],
  "window": {"x": {"Hann": 0.5}, "u": {"Hann": 0.5}},
  "frequencies": {"rho": {"max": 8}, "nu": {"max": 8}}
}"#;
    let sound = |text: &str| {
        resolve(
            "scene",
            SceneFile::parse(text).unwrap(),
            ".".as_ref(),
            1 << 40,
        )
    };
    assert_eq!(sound(text).unwrap().planes.len(), 1);
    let dark = text.replace("\"size\": [0.2, 0.2]", "\"size\": [0.2, 0]");
    let told = sound(&dark).unwrap_err().in_text(&dark, &[]);
    assert_eq!(
        told,
        "line 2, column 62: light.size[1] is 0; allowed: 1e-9 to 1e9"
    );
    for (from, to, expected) in [
        (
            "{\"Hann\": 0.5}, \"u\"",
            "{\"Han\": 0.5}, \"u\"",
            "line 6, column 24: window.x: unknown variant `Han`, expected one of `Hann`, `Box`, `Gaussian` \
             (did you mean Hann?); allowed: a profile with its half-width in metres, such as Hann(0.5)",
        ),
        (
            "8}}\n}",
            "8}}\n} 1",
            "line 8, column 3: allowed: nothing after the last bracket",
        ),
    ] {
        let changed = text.replace(from, to);
        assert_eq!(
            SceneFile::parse(&changed).unwrap_err().to_string(),
            expected
        );
    }
}
