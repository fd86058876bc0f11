//! Defines the commands that are killed. Each command writes to a folder that contains an earlier
//! result and files of the user.

use crate::hostile::child;
use crate::hostile::folder::{self, Folder};
use crate::hostile::stages::{self, TETRA, words};
use std::fs;
use std::io;
use std::path::Path;
use std::time::{Duration, Instant};

/// A command that writes results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verb {
    Run,
    Measure,
    Predict,
    Compare,
    Sweep,
    Figure,
}

impl Verb {
    pub(super) const ALL: [Self; 6] = [
        Self::Run,
        Self::Measure,
        Self::Predict,
        Self::Compare,
        Self::Sweep,
        Self::Figure,
    ];

    /// The name of the index that the command writes into its folder.
    pub(super) fn index(self) -> &'static str {
        match self {
            Self::Run | Self::Compare => "summary.json",
            Self::Measure => "measurement.json",
            Self::Predict => "prediction.json",
            Self::Sweep => "sweep.json",
            Self::Figure => "scene/figure.json",
        }
    }

    /// The command line for a seed; commands with different seeds give different results.
    pub(super) fn arguments(self, seed: u64) -> Vec<String> {
        let ending = format!("--out out --quiet --threads 2 --seed {seed}");
        words(&match self {
            Self::Run => format!("run out/scene.ron {ending}"),
            Self::Measure => format!("measure out/scene.ron {ending}"),
            Self::Predict => format!("predict out/scene.ron {ending}"),
            Self::Compare => format!(
                "compare --measured in/{} --predicted in/p --out out --quiet --threads 2",
                if seed == EARLIER { "a" } else { "b" }
            ),
            Self::Sweep => format!("sweep out/scene.ron --set light.radiance=1,2 {ending}"),
            Self::Figure => format!(
                "figure out/scene.ron --set run.seed={seed} --quality draft --out out --quiet --threads 2"
            ),
        })
    }
}

/// The seed of the result that a folder contains before the trial.
pub(super) const EARLIER: u64 = 1;

/// A command, the content of its folder before the trial, and the duration of an undisturbed run.
#[derive(Debug)]
pub(super) struct KillTask {
    pub(super) verb: Verb,
    /// The files in `out` before the trial: the earlier result and the user's files.
    pub(super) before: Folder,
    /// The user's files in `out`.
    pub(super) foreign: Folder,
    /// The input files of the command `compare`.
    pub(super) inputs: Folder,
    pub(super) takes: Duration,
}

/// Makes all tasks; the tested program writes their earlier results.
pub(super) fn tasks(program: &Path, at: &Path) -> io::Result<Vec<KillTask>> {
    let place = at.join("tasks");
    folder::write(&place.join("out"), &users())?;
    for command in [
        "measure out/scene.ron --seed 1 --quiet --out in/a",
        "measure out/scene.ron --seed 2 --quiet --out in/b",
        "predict out/scene.ron --quiet --out in/p",
    ] {
        good(program, &place, &words(command), at)?;
    }
    let inputs = folder::read(&place.join("in"))?;
    let tasks = Verb::ALL.map(|verb| task(program, &place, verb, &inputs, at));
    let tasks = tasks.into_iter().collect();
    fs::remove_dir_all(place)?;
    tasks
}

fn task(
    program: &Path,
    place: &Path,
    verb: Verb,
    inputs: &Folder,
    at: &Path,
) -> io::Result<KillTask> {
    let out = place.join("out");
    let mut arguments = verb.arguments(EARLIER);
    if verb == Verb::Run {
        // The earlier result contains files that the next result does not contain.
        arguments.extend(words("--save photons"));
    }
    let mut takes = Duration::MAX;
    for _ in 0..3 {
        fs::remove_dir_all(&out)?;
        folder::write(&out, &users())?;
        let start = Instant::now();
        good(program, place, &arguments, at)?;
        takes = takes.min(start.elapsed());
    }
    let mut before = folder::read(&out)?;
    let mut foreign = users();
    foreign.insert("notes.txt".into(), Some(b"mine".to_vec()));
    foreign.insert("light/my.png".into(), Some(b"mine too".to_vec()));
    let result = |name: &&String| before[*name].is_some() && !foreign.contains_key(*name);
    if let Some(name) = before.keys().find(result).cloned() {
        let mut edited = before[&name].clone().unwrap_or_default();
        edited.push(b'!');
        foreign.insert(format!("{name}.edited"), Some(edited));
    }
    before.extend(foreign.clone());
    Ok(KillTask {
        verb,
        before,
        foreign,
        inputs: inputs.clone(),
        takes,
    })
}

/// The scene file, as placed in the folder of its results, and the mesh that the scene
/// uses.
fn users() -> Folder {
    let scene = stages::with_mesh().replace("meshes/tetra.obj", "tetra.obj");
    folder::of([("scene.ron", scene.into()), ("tetra.obj", TETRA.into())])
}

fn good(program: &Path, place: &Path, arguments: &[String], scratch: &Path) -> io::Result<()> {
    let ended = child::call(program, place, arguments, scratch)?;
    if matches!(ended.code, Some(0 | 1 | 4)) {
        return Ok(());
    }
    let (command, message) = (arguments.join(" "), String::from_utf8_lossy(&ended.stderr));
    Err(io::Error::other(format!("etendue {command}: {message}")))
}
