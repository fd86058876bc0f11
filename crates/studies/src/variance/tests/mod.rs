//! Tests of the crate: spectra of point sets, predictions for known fields, and a scene.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

mod known_field;
mod periodograms;
mod scenes;

use crate::variance::{AxisPairs, Sampler};
use etendue_scene::{Scene, SceneFile, resolve};
use std::path::{Path, PathBuf};

/// Every sampler that is not a file.
fn samplers() -> [Sampler; 6] {
    [
        Sampler::Independent,
        Sampler::Jitter,
        Sampler::LatinHypercube,
        Sampler::Sobol,
        Sampler::Padded(AxisPairs::PositionWithSlope),
        Sampler::Padded(AxisPairs::PositionAndSlope),
    ]
}

/// A scene of the folder `scenes/variance`, with some of its text replaced.
fn scene(name: &str, edits: &[(&str, &str)]) -> Scene {
    let folder = PathBuf::from(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../scenes/variance"
    ));
    let mut text = std::fs::read_to_string(folder.join(name)).unwrap();
    for (from, to) in edits {
        assert!(text.contains(from), "{from} is not in the scene");
        text = text.replacen(from, to, 1);
    }
    let file = SceneFile::parse(&text).unwrap();
    resolve(name, file, Path::new(""), u64::MAX).unwrap()
}
