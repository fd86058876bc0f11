//! Mutated scene files, and the scenes of the repository from which they are derived.

use super::case::{Attack, INJECTED};
use super::dice::Dice;
use super::folder::{self, Folder};
use super::text;
use std::fs;
use std::io;
use std::path::Path;

/// Tokens of scene files.
const WORDS: &str = "() | [] | Emission | Box(0.1) | Hann(1e-9) | Gaussian(width: 1, cut: 1e9) | \
    After(\"blockers\") | Before(\"floor\") | Distance(1) | Distance(1e-12) | Rectangle | Mesh | \
    Smooth | Mirror | ThinLens(1e-9) | Refraction(front: 1, back: 1.5) | \
    Refraction(front: 1e9, back: 1e-9) | Sphere(1000) | Sphere(-2) | Cylinder(3) | \
    Paraboloid(1e6, -1e6) | Star(radius: 0.1, relief: 0.9, lobes: 4294967295, rings: 2048) | \
    File(\"scene.ron\") | File(\"/dev/zero\") | File(\"..\") | Phong(1e9) | LocalNormals | \
    Tangent | Plain | true";

/// Links below the folder of results that lead out of it, with their targets. The folder itself may
/// be a link, because the user names it.
const LINKS: [[&str; 2]; 4] = [
    ["out/green", "../../elsewhere"],
    ["out/summary.json", "../../elsewhere/kept"],
    ["out/receiver", "../../elsewhere"],
    ["out/.etendue.lock", "../../elsewhere/kept"],
];

/// Names of folders for results. In some of them, a line begins.
const FOLDERS: [&str; 5] = ["out", "a\nEND\nLINE", "a\rLINE", "a'\nLINE", "'; LINE"];

/// The texts of all scenes of the repository, without their comments.
pub(crate) fn seeds() -> io::Result<Vec<String>> {
    let mut texts = Vec::new();
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    for folder in [scenes.clone(), scenes.join("table1"), scenes.join("words")] {
        let mut paths: Vec<_> = fs::read_dir(folder)?
            .map(|entry| Ok(entry?.path()))
            .collect::<io::Result<_>>()?;
        paths.retain(|path| path.extension().is_some_and(|e| e == "ron"));
        // The order of directory entries depends on the system.
        paths.sort();
        for path in paths {
            let text = fs::read_to_string(path)?;
            let lines = text.lines();
            let code = lines.map(|line| line.split("//").next().unwrap_or_default());
            texts.push(code.collect::<Vec<_>>().join("\n"));
        }
    }
    Ok(texts)
}

/// One of the scenes, and its text after mutations.
pub(super) fn mutated<'a>(seeds: &'a [String], dice: &mut Dice) -> (&'a str, Vec<u8>) {
    let scene: &String = dice.pick(seeds);
    (scene, text::mutated(scene, WORDS, dice))
}

/// A mutated scene file.
pub(crate) fn attack(seeds: &[String], dice: &mut Dice) -> Attack {
    let (scene, text) = mutated(seeds, dice);
    Attack {
        sound: Some(folder::of([(SCENE, scene.into())])),
        ..on_scene(folder::of([(SCENE, text)]), dice)
    }
}

/// The name of a scene file.
pub(crate) const SCENE: &str = "scene.ron";

/// An attack that gives the program the scene file of a folder. The program always checks
/// the scene, and in one of eight cases, or beside a link, also runs, sweeps or draws it.
pub(crate) fn on_scene(files: Folder, dice: &mut Dice) -> Attack {
    let words = |line: &str| line.split_whitespace().map(str::to_owned).collect();
    let run = *dice.pick(&[
        "run scene.ron --photons 2000 --out out",
        "run scene.ron --photons 2000 --rgb --out out",
        "sweep scene.ron --photons 2000 --set run.seed=1,2 --out out",
        "figure scene.ron --set run.photons=16000 --quality draft --out out",
    ]);
    // Two azimuths are enough to test how the program treats values of fields.
    let run = format!("{run} --quiet --threads 2 --set frequencies.azimuths=2");
    let mut then: Vec<String> = words(&run);
    if dice.one_in(8) {
        then = words("split scene.ron --parts 2 --out");
        then.push(FOLDERS[dice.below(FOLDERS.len())].replace("LINE", INJECTED));
        then.extend(dice.one_in(2).then(|| "--slurm".to_owned()));
    }
    let link = dice.one_in(8).then(|| *dice.pick(&LINKS));
    Attack {
        files,
        arguments: words("check scene.ron"),
        then: (link.is_some() || dice.one_in(8)).then_some(then),
        // With fewer files, the program cannot be loaded.
        open_files: dice.one_in(2).then(|| 4 + dice.below(12)),
        link,
        ..Attack::default()
    }
}
