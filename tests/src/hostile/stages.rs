//! Mutated folders of stages (parts of a measurement, and predictions) that the command `compare`
//! reads.
//!
//! If a hash does not match after a change, the program must refuse the folder, or the change must
//! have no effect on the result. If all hashes match after a change, the program cannot detect the
//! change. Such a change tests the code that reads files after the check of hashes.

use super::case::{Attack, OUT};
use super::child;
use super::dice::Dice;
use super::folder::{self, Folder};
use super::{bytes, index, npz};
use std::fs;
use std::io;
use std::path::Path;

/// A scene that runs in a fraction of a second.
pub(crate) const SMALL: &str = r#"(
    light: Rectangle(center: (0.1, 0.2, 0.3), size: (0.2, 0.17)),
    blockers: [JitteredSquares(name: "blockers", center: (0.12, 0.2, 1.3),
                               count: (3, 2), pitch: 0.1, fill: 0.6, jitter: 0.3, seed: 7)],
    surfaces: [Rectangle(name: "floor", center: (0.1, 0.2, 2.2), size: (6, 6))],
    path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["floor"]),
    planes: [(name: "light", at: Emission), (name: "receiver", at: Before("floor"))],
    window: (x: Hann(0.5), u: Hann(0.3)),
    frequencies: (azimuths: 2, rho: (max: 3), nu: (max: 4)),
    run: (photons: 2000, seed: 1, batches: 32),
)"#;

/// The text of a second scene, which also contains a mesh from a file. For the scene with
/// a mesh, backward rays replace theory, and the folders of stages contain copies of the mesh
/// file.
pub(crate) fn with_mesh() -> String {
    let mesh = r#"blockers: [Mesh(name: "tetra", center: (0.1, 0.2, 1), 
        mesh: File("meshes/tetra.obj"), scale: 0.1), "#;
    SMALL.replace("blockers: [", mesh)
}

/// The OBJ file of the scene with a mesh.
pub(crate) const TETRA: &str =
    "v 1 1 1\nv -1 -1 1\nv -1 1 -1\nv 1 -1 -1\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n";

const COMPARE: &str = "compare --measured a b --predicted p --out out --quiet --threads 1";

/// Valid folders of the measurement and of the prediction, and the summary of their comparison.
#[derive(Debug)]
pub(crate) struct Seed {
    files: Folder,
    summary: Vec<u8>,
}

/// Measures and predicts both scenes, in subfolders of `at`.
pub(crate) fn seeds(program: &Path, at: &Path) -> io::Result<Vec<Seed>> {
    let scenes = [SMALL.to_owned(), with_mesh()];
    scenes
        .iter()
        .map(|scene| seed(program, at, scene))
        .collect()
}

fn seed(program: &Path, at: &Path, scene: &str) -> io::Result<Seed> {
    let work = at.join("stages");
    let files = [
        ("small.ron", scene.into()),
        ("meshes/tetra.obj", TETRA.into()),
    ];
    folder::write(&work, &folder::of(files))?;
    for command in [
        "measure small.ron --out a --batches 0..20 --quiet --threads 1",
        "measure small.ron --out b --batches 20..32 --quiet --threads 1",
        "predict small.ron --out p --quiet --threads 1",
        COMPARE,
    ] {
        let ended = child::call(program, &work, &words(command), at)?;
        if !matches!(ended.code, Some(0 | 1 | 4)) {
            let message = String::from_utf8_lossy(&ended.stderr);
            let failed = format!("etendue {command}: {message}");
            return Err(io::Error::other(failed));
        }
    }
    let summary = fs::read(work.join(OUT).join("summary.json"))?;
    let mut files = folder::read(&work)?;
    files.retain(|name, _| ["a/", "b/", "p/"].iter().any(|f| name.starts_with(f)));
    fs::remove_dir_all(&work)?;
    Ok(Seed { files, summary })
}

/// A command line without quotes, split into words.
pub(crate) fn words(command: &str) -> Vec<String> {
    command.split_whitespace().map(str::to_owned).collect()
}

/// A mutated part of a measurement.
pub(crate) fn part(seeds: &[Seed], dice: &mut Dice) -> io::Result<Attack> {
    let stage = *dice.pick(&["a/", "b/"]);
    attack(dice.pick(seeds), stage, "measurement.json", dice)
}

/// A mutated prediction.
pub(crate) fn prediction(seeds: &[Seed], dice: &mut Dice) -> io::Result<Attack> {
    attack(dice.pick(seeds), "p/", "prediction.json", dice)
}

fn attack(seed: &Seed, stage: &str, index: &str, dice: &mut Dice) -> io::Result<Attack> {
    let mut files = seed.files.clone();
    let index = format!("{stage}{index}");
    let fits = match dice.below(10) {
        0..3 => change_index(&mut files, &index, dice),
        3 => change_scene(&mut files, dice),
        _ => change_file(&mut files, stage, &index, dice)?,
    };
    // If all hashes match although the mutation has changed something, the summary may differ from
    // the summary of valid folders.
    let summary = (!fits || files == seed.files).then(|| seed.summary.clone());
    Ok(Attack {
        files,
        arguments: words(COMPARE),
        summary,
        ..Attack::default()
    })
}

/// Changes an index, and returns whether the index's own hash matches its text.
fn change_index(files: &mut Folder, index: &str, dice: &mut Dice) -> bool {
    let old = text(files, index);
    if dice.one_in(3)
        && let Some(new) = index::with_other_value(&old, dice)
    {
        files.insert(index.to_owned(), Some(new.into_bytes()));
        return true;
    }
    let new = index::mutated(&old, dice);
    files.insert(index.to_owned(), Some(new));
    false
}

/// Makes the same change to the scene in all indices, and updates their hashes to match.
fn change_scene(files: &mut Folder, dice: &mut Dice) -> bool {
    let indices = [
        "a/measurement.json",
        "b/measurement.json",
        "p/prediction.json",
    ];
    let Some(scene) = index::other_scene(&text(files, indices[0]), dice) else {
        return false;
    };
    for index in indices {
        if let Some(new) = index::with_scene(&text(files, index), &scene) {
            files.insert(index.to_owned(), Some(new.into_bytes()));
        }
    }
    true
}

/// Changes or removes a file other than the index, and returns whether the hash in the index
/// matches this file.
fn change_file(files: &mut Folder, stage: &str, index: &str, dice: &mut Dice) -> io::Result<bool> {
    let own = |(name, bytes): &(&String, &Option<Vec<u8>>)| {
        bytes.is_some() && name.starts_with(stage) && *name != index
    };
    let names: Vec<String> = files.iter().filter(own).map(|(n, _)| n.clone()).collect();
    let name = dice.pick(&names).clone();
    let old = files.remove(&name).flatten().unwrap_or_default();
    let new = match dice.below(12) {
        0 => return Ok(false),
        1 => {
            files.insert(format!("{name}/file"), Some(old));
            return Ok(false);
        }
        2 => Vec::new(),
        // The replacement for a file is the content of another file.
        3 => files
            .get(dice.pick(&names))
            .cloned()
            .flatten()
            .unwrap_or_default(),
        6.. if name.ends_with(".npz") => npz::mutated(&old, dice)?,
        _ => {
            let mut new = old.clone();
            bytes::mutate(&mut new, dice);
            new
        }
    };
    let fits = dice.one_in(2) && new != old;
    if fits {
        let sealed = index::with_hash_of(&text(files, index), &old, &new);
        files.insert(index.to_owned(), Some(sealed.into_bytes()));
    }
    files.insert(name, Some(new));
    Ok(fits)
}

fn text(files: &Folder, name: &str) -> String {
    let bytes = files.get(name).cloned().flatten().unwrap_or_default();
    String::from_utf8_lossy(&bytes).into_owned()
}
