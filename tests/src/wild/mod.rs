//! Searches for scenes for which Étendue gives a wrong verdict.
//!
//! The search draws scenes that use all features of scene files, and runs them as a user runs
//! them. If a run panics, hangs or fails with several seeds, the search reduces its scene as far
//! as possible and saves the scene.

mod blockers;
mod colors;
mod draw;
mod judge;
mod light;
mod lights;
mod pictures;
mod plain;
mod planes;
mod planted;
mod reflects;
mod run;
mod scene;
mod several;
mod shrink;
mod small;
mod straight;
mod surfaces;
mod tally;

pub(crate) use judge::HANDFUL;
pub(crate) use plain::plain_scene;
pub(crate) use run::text;
pub(crate) use scene::scene;
pub(crate) use several::several;
pub(crate) use small::{MORE_PHOTONS, SmallOptions, small};

use crate::hostile::{child, on_threads};
use crate::progress::progress;
use crate::report::ReportSection;
use blockers::SoughtFeature;
use judge::{JudgedScene, judge};
use run::Runner;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;
use tally::Tally;

/// Options of the search.
#[derive(Debug, clap::Args)]
pub(crate) struct WildOptions {
    /// Number of scenes.
    #[arg(long, default_value_t = 100)]
    scenes: u64,
    /// Index of the first scene.
    #[arg(long, default_value_t = 0)]
    first: u64,
    /// Seed of the random scenes.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Photons per run.
    #[arg(long, default_value_t = 200_000)]
    photons: u64,
    /// Seconds after which a run counts as hung.
    #[arg(long, default_value_t = 60)]
    limit: u64,
    /// Seconds to spend on reducing a scene.
    #[arg(long, default_value_t = 120)]
    shrink: u64,
    /// Number of scenes that run in parallel [default: one for each core].
    #[arg(long)]
    threads: Option<usize>,
    /// Folder for scenes with a fault.
    #[arg(long, default_value = "target/wild")]
    out: PathBuf,
    /// Add this feature to each scene without it, and pass over scenes to which it cannot be added.
    #[arg(long, value_name = "KIND")]
    with: Option<SoughtFeature>,
    /// Only draw the scenes and save all of them, without running any.
    #[arg(long)]
    draw: bool,
    /// Program to test [default: etendue in the same folder].
    #[arg(long)]
    etendue: Option<PathBuf>,
}

/// Runs all scenes.
pub(crate) fn wild(options: &WildOptions) -> io::Result<ReportSection> {
    let program = child::program(options.etendue.as_deref())?;
    let place = tempfile::tempdir()?;
    let bar = progress(options.scenes, "scenes");
    let numbers = options.first..options.first + options.scenes;
    let tell = |number: u64, says: &str| bar.suspend(|| told(options.seed, number, says));
    let judged = on_threads(options.threads, numbers, &bar, |thread, number| {
        let at = place.path().join(format!("{thread}-{number}"));
        let judged = one(options, &program, number, &at, &tell)?;
        fs::remove_dir_all(&at)?;
        Ok(judged)
    })?;
    let mut tally = Tally::default();
    for (number, judged) in &judged {
        match judged {
            Some(judged) => tally.add(*number, judged),
            None if options.with.is_none() => tally.undrawn(*number),
            None => {}
        }
    }
    Ok(tally.section(options.seed))
}

#[expect(clippy::print_stderr, reason = "findings are told as they come")]
fn told(seed: u64, number: u64, says: &str) {
    eprintln!("seed {seed}, scene {number}: {says}");
}

/// Draws, runs and judges a scene; if the run shows a fault, saves the scene and reports the
/// fault. Returns `None` if no scene could be drawn, or if the scene lacks the selected blockers.
fn one(
    options: &WildOptions,
    program: &Path,
    number: u64,
    at: &Path,
    tell: &dyn Fn(u64, &str),
) -> io::Result<Option<JudgedScene>> {
    let runner = Runner {
        program: program.to_owned(),
        folder: at.join("scene"),
        scratch: at.join("scratch"),
        limit: Duration::from_secs(options.limit),
    };
    fs::create_dir_all(&runner.folder)?;
    fs::create_dir_all(&runner.scratch)?;
    let Ok(mut file) = scene(options.seed, number, options.photons, &runner.folder) else {
        return Ok(None);
    };
    let of = (options.seed, number);
    match options.with {
        Some(SoughtFeature::Lights) => lights::add_lights(&mut file, of, &runner.folder)?,
        Some(SoughtFeature::Colors) => file = colors::add_colors(&file, of, &runner.folder)?,
        Some(feature) => blockers::add_layer(&mut file, feature, of, &runner.folder)?,
        None => {}
    }
    let has = |kind: SoughtFeature| match kind {
        SoughtFeature::Colors => true,
        SoughtFeature::Lights => !file.other_lights.is_empty(),
        kind => file.blockers.iter().any(|blockers| kind.is_of(blockers)),
    };
    if !options.with.is_none_or(has) {
        return Ok(None);
    }
    if options.draw {
        keep(options, number, "drawn", &text(&file)?, &runner.folder)?;
        return Ok(Some(JudgedScene::default()));
    }
    let judged = judge(&runner, &file)?;
    if let Some(why) = &judged.refused {
        tell(number, &format!("refused: {why}"));
        keep(options, number, "refused", &text(&file)?, &runner.folder)?;
    }
    for (trouble, says) in &judged.troubles {
        tell(number, says);
        keep(options, number, "drawn", &text(&file)?, &runner.folder)?;
        let time = Duration::from_secs(options.shrink);
        let small = shrink::shrink(&runner, &file, trouble, time)?;
        let small = format!("// {}\n{}", says.replace('\n', " "), text(&small)?);
        keep(options, number, "small", &small, &runner.folder)?;
        tell(number, &format!("the smallest found:\n{small}"));
    }
    Ok(Some(judged))
}

/// Saves a scene with its pictures and meshes.
fn keep(options: &WildOptions, number: u64, what: &str, text: &str, from: &Path) -> io::Result<()> {
    let folder = options.out.join(format!("{}-{number}", options.seed));
    fs::create_dir_all(&folder)?;
    for file in fs::read_dir(from)? {
        let path = file?.path();
        let input = path.file_name().filter(|name| *name != "scene.ron");
        if let Some(name) = input {
            fs::copy(&path, folder.join(name))?;
        }
    }
    fs::write(folder.join(format!("{what}.ron")), text)
}
