//! Helpers shared by the tests of the command.

#![allow(
    dead_code,
    unreachable_pub,
    reason = "each test file uses its own part"
)]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use ndarray::{Array, Dimension};
use ndarray_npy::{NpzReader, ReadableElement};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// The path of a scene of this repository.
pub fn scene(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../scenes")
        .join(name)
}

pub fn etendue() -> Command {
    Command::new(env!("CARGO_BIN_EXE_etendue"))
}

/// All files of a folder, by their relative names.
pub fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path
                    .strip_prefix(folder)
                    .unwrap()
                    .to_string_lossy()
                    .into_owned();
                found.insert(name, fs::read(&path).unwrap());
            }
        }
    }
    found
}

/// All files of a result except for its times, which no two runs share.
#[track_caller]
pub fn untimed(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = files(folder);
    assert!(files.remove("timing.json").is_some());
    files
}

/// A small scene with many numbers that inexact decimal conversion would change. Two runs of one
/// seed share photons, because they use nets; lattices depend on the scene and on the number of
/// photons.
pub const SCENE: &str = r#"(
    light: Rectangle(center: (0.1, 0.2, 0.30000000000000004), size: (0.2, 0.17320508075688773)),
    blockers: [JitteredSquares(name: "blockers", center: (0.1234567890123456, 0.2, 1.3000000000000003),
                               count: (5, 4), pitch: 0.10000000000000002, fill: 0.5999999999999999,
                               jitter: 0.3, seed: 18446744073709551615)],
    surfaces: [Rectangle(name: "floor", center: (0.1, 0.2, 2.2360679774997896), size: (6, 6))],
    path: (direction: (0, 0, 1), x_axis: (0.6180339887498949, 1, 0), visits: ["floor"]),
    planes: [(name: "light", at: Emission), (name: "receiver", at: Before("floor"))],
    window: (x: Hann(0.5), y: Box(0.4142135623730951), u: Hann(0.30000000000000004)),
    frequencies: (azimuths: 3, rho: (max: 6), nu: (max: 9)),
    run: (photons: 20000, seed: 18446744073709551557, sampling: Net),
)"#;

/// A folder with the small scene, `small.ron`.
pub fn small() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("small.ron"), SCENE).unwrap();
    folder
}

/// A folder with the scene `small.ron`, its prediction `p`, and its measurement in two
/// parts: `a` has the batches 0..20, and `b` has 20..64.
pub fn stages() -> TempDir {
    let folder = small();
    for arguments in [
        "measure small.ron --out a --batches 0..20 --threads 1",
        "measure small.ron --out b --batches 20..64 --threads 3",
        "predict small.ron --out p",
    ] {
        let output = call(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments}: {output:?}");
        assert!(output.stdout.is_empty() && output.stderr.is_empty());
    }
    folder
}

/// Runs `etendue` with the given arguments and `--quiet`; file names are relative to `folder`.
pub fn call(folder: &Path, arguments: &str) -> Output {
    etendue()
        .current_dir(folder)
        .args(arguments.split_whitespace())
        .arg("--quiet")
        .output()
        .unwrap()
}

/// Runs `etendue` with the given arguments, and prints what it prints without `--quiet`.
pub fn loud(folder: &Path, arguments: &str) -> Output {
    let mut command = etendue();
    let command = command
        .current_dir(folder)
        .args(arguments.split_whitespace());
    command.output().unwrap()
}

/// The output of a command that ends with an exit code.
#[track_caller]
fn ended(output: Output, arguments: &str, code: i32) -> Output {
    assert_eq!(output.status.code(), Some(code), "{arguments}: {output:?}");
    output
}

/// Runs [`call`] and checks that the command succeeds.
#[track_caller]
pub fn passes(folder: &Path, arguments: impl AsRef<str>) -> Output {
    let arguments = arguments.as_ref();
    ended(call(folder, arguments), arguments, 0)
}

/// Runs [`loud`] and checks the exit code; returns the standard output.
#[track_caller]
pub fn told(folder: &Path, arguments: impl AsRef<str>, code: i32) -> String {
    let arguments = arguments.as_ref();
    let output = ended(loud(folder, arguments), arguments, code);
    String::from_utf8(output.stdout).unwrap()
}

/// Runs [`call`] and checks that the command fails with an exit code; returns its message.
#[track_caller]
pub fn fails(folder: &Path, arguments: impl AsRef<str>, code: i32) -> String {
    let arguments = arguments.as_ref();
    let output = ended(call(folder, arguments), arguments, code);
    String::from_utf8(output.stderr).unwrap()
}

/// Checks that the command refuses bad input. It must print one line with all `parts`, and must not
/// write to `out`.
pub fn refused(folder: &Path, arguments: &str, parts: &[&str]) {
    let output = call(folder, arguments);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{arguments}: {message}");
    assert!(message.starts_with("error: "), "{arguments}: {message}");
    assert_eq!(message.lines().count(), 1, "{arguments}: {message}");
    for part in parts {
        assert!(
            message.contains(part),
            "{arguments}: {part} not in: {message}"
        );
    }
    assert!(!folder.join("out").exists(), "{arguments}: out was written");
}

/// A JSON object that ends with its own hash, as the indices of results do.
pub fn sealed(mut tree: Value) -> Vec<u8> {
    tree.as_object_mut().unwrap().remove("index_hash");
    let text = tree.to_string();
    let body = text.strip_suffix('}').unwrap();
    let hash = blake3::hash(body.as_bytes()).to_hex();
    format!("{body},\n  \"index_hash\": \"{hash}\"\n}}\n").into_bytes()
}

pub fn json(file: &Path) -> Value {
    serde_json::from_slice(&fs::read(file).unwrap()).unwrap()
}

/// Reads an array of an NPZ file; the array must be in C order.
pub fn array<A: ReadableElement, D: Dimension>(file: &Path, name: &str) -> Array<A, D> {
    let mut npz = NpzReader::new(File::open(file).unwrap()).unwrap();
    let array: Array<A, D> = npz.by_name(name).unwrap();
    assert!(array.is_standard_layout(), "{name}: C order");
    array
}
