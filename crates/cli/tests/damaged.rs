//! Tests that `compare` refuses changed stage files, and names the file and the array.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common;
use crate::common::{array, call, json, passes, refused, sealed, stages};
use etendue_field::Complex;
use ndarray::{Array4, ArrayD};
use ndarray_npy::{NpzReader, WritableElement, WriteNpyExt};
use serde_json::{Value, json};
use std::fs;
use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

const COMPARE: &str = "compare --measured a b --predicted p --out out";

const LEDGER: &str = "a/ledger.npz";
const BATCHES: &str = "a/receiver/batches.npz";
const PREDICTION: &str = "p/receiver/prediction.npz";

/// A file whose content is replaced temporarily.
struct Swap {
    path: PathBuf,
    whole: Vec<u8>,
}

impl Swap {
    fn new(path: PathBuf, bytes: &[u8]) -> Self {
        let whole = fs::read(&path).unwrap();
        fs::write(&path, bytes).unwrap();
        Self { path, whole }
    }
}

impl Drop for Swap {
    fn drop(&mut self) {
        fs::write(&self.path, &self.whole).unwrap();
    }
}

/// Writes the changed index in place of the index.
fn changed(index: &Path, change: impl FnOnce(&mut Value)) -> Swap {
    let mut tree = json(index);
    change(&mut tree);
    Swap::new(index.to_owned(), &sealed(tree))
}

/// Checks that `compare` refuses `file` with other bytes, even if the index has the hash of these
/// bytes.
fn refused_with(folder: &Path, file: &str, bytes: &[u8], parts: &[&str]) {
    let (stage, name) = file.split_once('/').unwrap();
    let index = ["measurement.json", "prediction.json"].map(|index| folder.join(stage).join(index));
    let index = index.iter().find(|index| index.exists()).unwrap();
    let hash = blake3::hash(bytes).to_hex();
    let _index = changed(index, |tree| tree["files"][name] = json!(hash.as_str()));
    let _file = Swap::new(folder.join(file), bytes);
    refused(folder, COMPARE, &[&[file], parts].concat());
}

/// The NPZ file with an array replaced, or without this array.
fn with_array(npz: &[u8], name: &str, content: Option<&[u8]>) -> Vec<u8> {
    let mut old = ZipArchive::new(Cursor::new(npz)).unwrap();
    let mut new = ZipWriter::new(Cursor::new(Vec::new()));
    let name = format!("{name}.npy");
    for i in 0..old.len() {
        let entry = old.by_index_raw(i).unwrap();
        if entry.name() != name {
            new.raw_copy_file(entry).unwrap();
        }
    }
    if let Some(content) = content {
        new.start_file(name, SimpleFileOptions::default()).unwrap();
        new.write_all(content).unwrap();
    }
    new.finish().unwrap().into_inner()
}

/// The bytes of an NPY file with an array.
fn npy<A: WritableElement>(array: &ArrayD<A>) -> Vec<u8> {
    let mut bytes = Vec::new();
    array.write_npy(&mut bytes).unwrap();
    bytes
}

#[test]
fn a_changed_index_is_refused() {
    let stages = stages();
    let folder = stages.path();
    let (a, p) = ("a/measurement.json", "p/prediction.json");
    type Change = fn(&mut Value);
    let cases: [(&str, Change, &[&str]); 13] = [
        (
            a,
            |t| t["version"] = json!("0.0.9"),
            &["0.0.9", "the same version"],
        ),
        (
            p,
            |t| t["version"] = json!("9.0.0"),
            &["9.0.0", "the same version"],
        ),
        (
            a,
            |t| t["scene_file"]["run"]["seed"] = json!(2),
            &["scene_hash"],
        ),
        (
            p,
            |t| t["scene_file"]["window"] = json!(2),
            &["WindowFile", "line"],
        ),
        (
            a,
            |t| t["batches"] = json!({"start": 5, "end": 99}),
            &["5..99", "0..64"],
        ),
        (
            a,
            |t| t["batches"] = json!({"start": 1, "end": 21}),
            &["array batch", "1..21"],
        ),
        (
            a,
            |t| t["photons"] = json!(5),
            &["ledger.npz", "array emitted"],
        ),
        (a, |t| t["method"] = json!("magic"), &["magic", "photons"]),
        (
            a,
            |t| t["seed"] = json!(3),
            &["its seed is 3, but the seed of its scene is 18446744073709551557"],
        ),
        (
            a,
            |t| t["files"] = json!({}),
            &["files does not list ledger.npz"],
        ),
        (
            p,
            |t| t["planes"] = json!([]),
            &["planes are []", "[light, receiver]"],
        ),
        (
            p,
            |t| t["planes"][0]["class"] = json!("guess"),
            &["guess", "exact"],
        ),
        (
            p,
            |t| t["planes"][0]["class"] = json!("reference"),
            &["the class of plane light"],
        ),
    ];
    for (name, change, parts) in cases {
        let _index = changed(&folder.join(name), change);
        refused(folder, COMPARE, &[&[&name[..2]], parts].concat());
    }
    // In the cases above, the index has the hash of the changed bytes. If it has another hash, any
    // changed bit is detected.
    for name in [a, p] {
        let whole = fs::read(folder.join(name)).unwrap();
        for i in 0..75 {
            let mut bytes = whole.clone();
            let bit = i * (8 * whole.len() - 1) / 74;
            bytes[bit / 8] ^= 1 << (bit % 8);
            let _index = Swap::new(folder.join(name), &bytes);
            refused(folder, COMPARE, &[name]);
        }
        let start = fs::read(folder.join(name)).unwrap()[..200].to_vec();
        for content in [b"", &b"[]"[..], b"{}", b"null", b"\0", b"\xff", &start] {
            let _index = Swap::new(folder.join(name), content);
            refused(folder, COMPARE, &[name]);
        }
    }
    // The unmodified files pass, so only the changes can cause the refusals.
    passes(folder, COMPARE);
}

#[test]
fn changed_files_are_refused() {
    let stages = stages();
    let folder = stages.path();
    for file in [LEDGER, BATCHES, PREDICTION] {
        let whole = fs::read(folder.join(file)).unwrap();
        let mut flipped = whole.clone();
        flipped[whole.len() / 2] ^= 1;
        for bytes in [&whole[..whole.len() / 2], b"", b"PK\x03\x04", &flipped] {
            {
                let _file = Swap::new(folder.join(file), bytes);
                refused(folder, COMPARE, &[file, "is damaged"]);
            }
            // Even if the hash in the index matches, a changed bit is detected.
            refused_with(folder, file, bytes, &[]);
        }
        fs::remove_file(folder.join(file)).unwrap();
        refused(folder, COMPARE, &[file, "No such file"]);
        fs::write(folder.join(file), whole).unwrap();
    }
    passes(folder, COMPARE);
}

/// For each array of each file, the test removes the array, changes its type, makes it too large
/// for memory, or replaces it by something that is not an array.
#[test]
fn foreign_arrays_are_refused() {
    let stages = stages();
    let folder = stages.path();
    let foreign = npy(&ArrayD::from_elem(vec![2, 2], 1.0_f32));
    let huge = "{'descr': '<f8', 'fortran_order': False, 'shape': (1099511627776,), }";
    let huge = format!("{huge:117}\n").into_bytes();
    let huge = [b"\x93NUMPY\x01\x00\x76\x00", &huge[..]].concat();
    let contents = [
        None,
        Some(&foreign[..]),
        Some(&huge),
        Some(b"text"),
        Some(b""),
    ];
    for file in [LEDGER, BATCHES, PREDICTION] {
        let whole = fs::read(folder.join(file)).unwrap();
        let names = NpzReader::new(Cursor::new(&whole))
            .unwrap()
            .names()
            .unwrap();
        for array in &names {
            for content in contents {
                let bytes = with_array(&whole, array, content);
                refused_with(folder, file, &bytes, &[&format!("array {array}: ")]);
            }
        }
    }
}

#[test]
fn wrong_numbers_are_refused() {
    let stages = stages();
    let folder = stages.path();
    let numbers = |shape: &[usize], value: f64| npy(&ArrayD::from_elem(shape, value));
    let counts = |shape: &[usize], value: u64| npy(&ArrayD::from_elem(shape, value));
    let slices: Array4<Complex> = array(&folder.join(BATCHES), "slices");
    let mut broken = slices.clone();
    broken[[19, 2, 1, 3]].im = f64::NAN;
    let turned = slices.permuted_axes([0, 2, 1, 3]);
    for (file, array, content, part) in [
        (
            LEDGER,
            "ledger",
            numbers(&[20, 4], f64::INFINITY),
            "not finite",
        ),
        (
            LEDGER,
            "ledger",
            numbers(&[20, 5], 1.0),
            "[20, 5]; must be [20, 4]",
        ),
        (
            LEDGER,
            "emitted",
            counts(&[20], u64::MAX),
            "photons of the batches",
        ),
        (
            BATCHES,
            "emitted",
            counts(&[20], 5),
            "photons of the batches",
        ),
        (
            BATCHES,
            "tally",
            counts(&[20, 3], 1),
            "the sum of `inside` and `outside`",
        ),
        (
            BATCHES,
            "tally",
            counts(&[20, 3], u64::MAX),
            "the sum of `inside` and `outside`",
        ),
        (BATCHES, "slices", npy(&broken.into_dyn()), "not finite"),
        (
            BATCHES,
            "slices",
            npy(&turned.into_dyn()),
            "must be [20, 3, ",
        ),
        (
            BATCHES,
            "projection",
            numbers(&[20, 64, 65], 0.0),
            "must be [20, 64, 64]",
        ),
        (
            PREDICTION,
            "projection",
            numbers(&[64, 64], f64::NAN),
            "not finite",
        ),
        (
            PREDICTION,
            "unblocked",
            numbers(&[], f64::NAN),
            "not finite",
        ),
        (PREDICTION, "values", numbers(&[1], 0.0), "[1]; must be"),
        (BATCHES, "azimuth", numbers(&[3], 0.5), "must be the axis"),
        (
            PREDICTION,
            "azimuth",
            numbers(&[3], 0.5),
            "must be the axis",
        ),
    ] {
        let bytes = with_array(&fs::read(folder.join(file)).unwrap(), array, Some(&content));
        refused_with(folder, file, &bytes, &[&format!("array {array}: "), part]);
    }
    passes(folder, COMPARE);
}

/// Tests headers on which the library would hang or overflow the stack.
#[test]
fn nested_headers_are_refused_at_once() {
    let stages = stages();
    let folder = stages.path();
    let whole = fs::read(folder.join(LEDGER)).unwrap();
    for (open, close, depth) in [
        ("[", "]", 24),
        ("[", "]", 2000),
        ("(", ")", 5000),
        ("{", "}", 9),
    ] {
        let [open, close] = [open, close].map(|bracket| bracket.repeat(depth));
        let shape = format!("{open}{close}");
        let fields = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}\n");
        let length = u16::try_from(fields.len()).unwrap().to_le_bytes();
        let npy = [b"\x93NUMPY\x01\x00", &length[..], fields.as_bytes()].concat();
        let bytes = with_array(&whole, "ledger", Some(&npy));
        let start = std::time::Instant::now();
        refused_with(folder, LEDGER, &bytes, &["array ledger: "]);
        assert!(start.elapsed().as_secs() < 20, "{depth}");
    }
}

/// If a part of a measurement is a pipe, a device or a link that leads out of the folder, it is
/// refused.
#[cfg(unix)]
#[test]
fn parts_are_regular_files_below_their_folder() {
    use std::os::unix::fs::symlink;
    let stages = stages();
    let folder = stages.path();
    let indices = ["a/measurement.json", "p/prediction.json"];
    for file in [LEDGER, BATCHES, PREDICTION].into_iter().chain(indices) {
        let path = folder.join(file);
        fs::rename(&path, folder.join("kept")).unwrap();
        let made = std::process::Command::new("mkfifo").arg(&path).status();
        assert!(made.unwrap().success());
        refused(folder, COMPARE, &[file, "not a regular file"]);
        for target in ["/dev/zero", "../kept", "../../kept"] {
            fs::remove_file(&path).unwrap();
            symlink(target, &path).unwrap();
            refused(folder, COMPARE, &[file]);
        }
        fs::remove_file(&path).unwrap();
        fs::rename(folder.join("kept"), path).unwrap();
    }
    passes(folder, COMPARE);
}

/// Tests that `compare` refuses parts measured with another mesh, because meshes belong to a scene,
/// and that it checks the copies of meshes.
#[test]
fn meshes_are_part_of_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    fs::write(at("tri.obj"), mesh).unwrap();
    let blocker = r#"blockers: [Mesh(name: "blockers", center: (0.1, 0.2, 1.3),
                     mesh: File("tri.obj"), scale: 0.1)],"#;
    let [start, end] = ["blockers: [", "surfaces: ["].map(|part| common::SCENE.find(part).unwrap());
    let scene = [&common::SCENE[..start], blocker, &common::SCENE[end..]].concat();
    fs::write(at("small.ron"), scene).unwrap();
    let ends = |arguments: &str, codes: &[i32]| {
        let output = call(folder.path(), arguments);
        let code = output.status.code().unwrap();
        assert!(codes.contains(&code), "{arguments}: {output:?}");
    };
    ends("measure small.ron --out a --batches 0..32", &[0]);
    ends("predict small.ron --out p", &[0]);
    ends("measure small.ron --out b --batches 32..64", &[0]);
    fs::write(at("tri.obj"), mesh.replace("1 0 0", "1.5 0 0")).unwrap();
    ends("measure small.ron --out other --batches 32..64", &[0]);
    for parts in ["a other", "other a"] {
        let arguments = format!("compare --measured {parts} --predicted p --out out");
        refused(
            folder.path(),
            &arguments,
            &["are incompatible: inputs.tri.obj is"],
        );
    }
    let copy = at("a/measurement.inputs/tri.obj");
    let whole = fs::read(&copy).unwrap();
    fs::write(&copy, mesh.replace("0 1 0", "0 2 0")).unwrap();
    refused(
        folder.path(),
        "compare --measured a b --predicted p --out out",
        &["a/measurement.inputs/tri.obj is damaged"],
    );
    fs::write(&copy, whole).unwrap();
    // The unmodified copy of the mesh is accepted again; the test ignores the verdict.
    ends("compare --measured b a --predicted p --out out", &[0, 1]);
}
