//! Tests whether each checked assumption of theory is needed.
//!
//! Each plane that violates exactly one assumption is predicted nevertheless, and the prediction
//! is compared with photons.

mod kind;
mod tally;
mod trial;

use crate::progress::progress;
use crate::report::ReportSection;
use crate::scenes::emit;
use crate::wild;
use etendue_scene::{Scene, SceneFile, resolve};
use rayon::prelude::*;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use tally::section;
use trial::{Trial, trials};

/// Options that select the tested scenes.
#[derive(Debug, clap::Args)]
pub(crate) struct AssumptionOptions {
    /// Number of random scenes.
    #[arg(long, default_value_t = 1000)]
    scenes: u64,
    /// Index of the first scene.
    #[arg(long, default_value_t = 0)]
    first: u64,
    /// Seed of the random scenes.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Photons per plane.
    #[arg(long, default_value_t = 200_000)]
    photons: u64,
}

/// The name of a scene and the trials of its planes; the trials are `None` if the scene could not
/// be generated or is invalid.
type TriedScene = (String, Option<Vec<Trial>>);

/// Runs the trials of all random scenes, and of the scenes in the repository.
pub(crate) fn assumptions(options: &AssumptionOptions) -> io::Result<ReportSection> {
    let mut files = Vec::new();
    files_of(Path::new(FOLDER), &mut files)?;
    let bar = progress(options.scenes + files.len() as u64, "scenes");
    let tried = |name: String, scene: Option<Scene>| -> TriedScene {
        let found = scene.as_ref().map(trials);
        for trial in found.iter().flatten() {
            bar.suspend(|| told(&name, trial));
        }
        bar.one();
        (name, found)
    };
    let numbers = options.first..options.first + options.scenes;
    let random: io::Result<Vec<TriedScene>> = numbers
        .into_par_iter()
        .map(|number| Ok(tried(number.to_string(), random(options, number)?)))
        .collect();
    let kept: Vec<TriedScene> = files
        .par_iter()
        .map(|path| {
            let name = path.file_stem().unwrap_or_default().to_string_lossy();
            tried(name.into_owned(), kept(path, options.photons))
        })
        .collect();
    bar.end();
    Ok(section(options, &random?, &kept))
}

/// A random scene.
fn random(options: &AssumptionOptions, number: u64) -> io::Result<Option<Scene>> {
    let folder = tempfile::tempdir()?;
    let file = wild::scene(options.seed, number, options.photons, folder.path());
    let scene = |file| resolve("random", file, folder.path(), u64::MAX).ok();
    Ok(file.ok().and_then(scene))
}

/// The scenes of the repository.
const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes");

/// The scene files in a folder and its subfolders, sorted by name.
fn files_of(folder: &Path, found: &mut Vec<PathBuf>) -> io::Result<()> {
    let entries: io::Result<Vec<_>> = fs::read_dir(folder)?.collect();
    let mut paths: Vec<PathBuf> = entries?.iter().map(fs::DirEntry::path).collect();
    paths.sort();
    for path in paths {
        if path.is_dir() {
            files_of(&path, found)?;
        } else if path.extension().is_some_and(|extension| extension == "ron") {
            found.push(path);
        }
    }
    Ok(())
}

/// Reads a scene of the repository, and sets its number of photons.
fn kept(path: &Path, photons: u64) -> Option<Scene> {
    let mut file = SceneFile::parse(&fs::read_to_string(path).ok()?).ok()?;
    emit(&mut file.run, Some(photons));
    resolve("kept", file, path.parent()?, u64::MAX).ok()
}

#[expect(clippy::print_stderr, reason = "findings are told as they come")]
fn told(name: &str, trial: &Trial) {
    let Trial {
        plane,
        broken,
        ending,
    } = trial;
    if let Some(ending) = ending {
        eprintln!("{name}, {plane}: {broken:?}: {ending:?}");
    }
}

#[cfg(test)]
mod tests {
    use super::trial::{Trial, TrialEnding, trials};
    use super::{FOLDER, Scene, SceneFile, kept, resolve};
    use etendue_compare::Verdict;
    use std::path::Path;

    /// Returns, for each plane that violates a single assumption, this assumption and the verdict
    /// of the comparison with photons.
    fn judged(scene: &Scene) -> Vec<(&'static str, Verdict)> {
        let judged = |trial: Trial| match trial.ending {
            Some(TrialEnding::Judged { verdict, .. }) => {
                trial.broken.first().map(|broken| (*broken, verdict))
            }
            _ => None,
        };
        trials(scene).into_iter().filter_map(judged).collect()
    }

    #[test]
    fn photons_reject_theory_where_an_assumption_is_broken() {
        let order = "no surface is in the way";
        let wrong = [
            ("hollow_twice", vec![]),
            ("self_shadow", vec![]),
            ("wall_in_the_way", vec![(order, Verdict::Fail)]),
            ("on_a_lens", vec![]),
        ];
        for (name, expected) in wrong {
            let path = Path::new(FOLDER).join(format!("wild/{name}.ron"));
            assert_eq!(judged(&kept(&path, 200_000).unwrap()), expected, "{name}");
        }
    }

    /// A fine mesh beside a mirror violates an assumption, but the prediction is wrong only if
    /// the mesh blocks light.
    #[test]
    fn photons_accept_theory_where_nothing_comes_of_it() {
        for (x, verdict) in [(3.0, Verdict::Pass), (0.55, Verdict::Fail)] {
            let text = format!(
                r#"(
                    light: Rectangle(center: (0, 0, 0), size: (0.2, 0.2)),
                    surfaces: [
                        Smooth(name: "mirror", center: (0, 0, 1), facing: (0, 0, -1),
                            form: Plane, aperture: 0.5, event: Mirror),
                        Mesh(name: "beside", center: ({x}, 0, 0.7),
                            mesh: Paraboloid(curvatures: (0, 0), half: 0.5, cells: 20)),
                    ],
                    path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["mirror"]),
                    planes: [(name: "plane", at: After("mirror"))],
                    window: (x: Hann(0.2), u: Hann(0.3)),
                    frequencies: (azimuths: 2, rho: (max: 8), nu: (max: 8)),
                    run: (photons: 200_000),
                )"#
            );
            let file = SceneFile::parse(&text).unwrap();
            let scene = resolve("scene", file, ".".as_ref(), u64::MAX).unwrap();
            assert_eq!(
                judged(&scene),
                [("no fine mesh is beside the path", verdict)],
                "{x}"
            );
        }
    }
}
