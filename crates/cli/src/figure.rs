//! `etendue figure`: the figures of Durand et al. 2005, made anew from measurement and theory, and figures of the user's scenes.

mod creatures;
mod criteria;
mod flat;
mod kernels;
mod own;
mod plates;
mod recipe;
mod rows;
mod shading;
mod shot;
mod spaces;
mod style;
mod table1;

use crate::args::FigureArgs;
use crate::conclude::code_of;
use crate::say_replaced;
use crate::threads::on_threads;
use crate::{progress, say};
use clap::ValueEnum;
use etendue_compare::{FullRadialReport, HighFrequencyShare, Verdict};
use etendue_figures::{Figure, Style};
use etendue_report::shell_word;
use etendue_scene::{Scene, SceneFile};
use etendue_store::Failure;
use etendue_store::sealed::json;
use etendue_store::stored::VERSION;
use etendue_store::{FIGURE, Plan, Results};
use recipe::{RECIPES, Recipe, Taken, Text};
use serde::Serialize;
use shot::Shot;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Instant;

/// How much work goes into a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Quality {
    /// An eighth of the photons of the scenes, twice as many frequencies as they ask for along each axis
    Draft,
    /// The photons of the scenes, four times as many frequencies
    Print,
    /// What it takes to have all texts in their places
    #[cfg(test)]
    #[value(skip)]
    Sketch,
}

impl Quality {
    /// Photons of a scene that has so many.
    fn photons(self, photons: u64) -> u64 {
        match self {
            Self::Draft => photons / 8,
            Self::Print => photons,
            #[cfg(test)]
            Self::Sketch => 1 << 14,
        }
    }

    /// Frequencies for one of the scene, along each axis. The window ends, so these are determined too: in between
    /// the picture shows what is there, and no cells.
    fn finer(self) -> usize {
        match self {
            Self::Draft => 2,
            Self::Print => 4,
            #[cfg(test)]
            Self::Sketch => 1,
        }
    }
}

/// Where figures go unless told otherwise.
pub(crate) const FOLDER: &str = "results/figures";

/// What a figure is made of.
pub(crate) struct Subject {
    /// Its folder below that of all figures.
    name: String,
    about: String,
    /// What stands behind `etendue figure` to make it again.
    arguments: String,
    /// The scenes that are run, at their own frequencies.
    scenes: Vec<Scene>,
    /// Whether these are the user's: then the index holds them.
    is_own: bool,
    /// Name and text of scene files of the repository, which are kept with it.
    texts: Vec<Text>,
    /// Files that must not be replaced.
    inputs: Vec<PathBuf>,
    /// Whether it shows curves or bars, which are kept as a table.
    has_table: bool,
    /// Whether it shows full radial spectra.
    full_radial: bool,
    /// Other scene files, from which curves are computed or measured.
    also: &'static [Text],
    /// The plane of each scene that is shown, where not all are.
    planes: Vec<String>,
    draw: fn(&Taken<'_>) -> Result<Figure, Failure>,
}

/// `etendue figure`: returns the exit code.
pub(crate) fn figure(args: &FigureArgs) -> Result<u8, Failure> {
    let subjects = if args.names.iter().any(|name| own::is_scene(name)) {
        vec![own::subject(args)?]
    } else {
        of_paper(args)?
    };
    let style = args.style.as_deref().map(style::read).transpose()?;
    on_threads(&args.threads, || {
        let bar = progress::steps("drawing", subjects.len(), "figures", args.quiet);
        let mut worst = Verdict::Pass;
        for subject in &subjects {
            bar.set_message(subject.name.clone());
            let begun = Instant::now();
            let verdict = bar.suspend(|| made(args, style, subject))?;
            if !args.quiet {
                let seconds = begun.elapsed().as_secs_f64();
                let verdict = etendue_pipeline::table::word(verdict);
                let Subject { name, about, .. } = subject;
                let line = format!("figure {name}: {verdict}, {seconds:.1} s: {about}");
                bar.suspend(|| say(&line));
            }
            worst = worst.and(verdict);
            bar.inc(1);
        }
        bar.finish_and_clear();
        if !args.quiet {
            say(&format!("figures in {}", args.out.display()));
        }
        Ok(code_of(worst))
    })
}

/// The figures of the paper that are asked for.
fn of_paper(args: &FigureArgs) -> Result<Vec<Subject>, Failure> {
    let of_scenes = [
        ("--set", !args.set.is_empty()),
        ("--plane", args.plane.is_some()),
    ];
    if let Some((option, _)) = of_scenes.iter().find(|(_, given)| *given) {
        let message = format!("{option} is for figures of scene files: etendue figure SCENE.ron");
        return Err(Failure::bad_input(message));
    }
    let is_all = args.names.iter().any(|name| name == "all");
    let recipes: Vec<&'static Recipe> = if is_all {
        RECIPES.iter().collect()
    } else {
        let recipes = args.names.iter().map(|name| recipe::named(name));
        recipes.collect::<Result<_, _>>()?
    };
    let subjects = recipes.into_iter();
    subjects.map(|recipe| recipe.subject()).collect()
}

/// `figure.json`, all but the hashes of the files.
#[derive(Debug, Serialize)]
struct Index<'a> {
    figure: &'a str,
    about: &'a str,
    /// What makes it again.
    command: String,
    version: &'a str,
    quality: Quality,
    /// What was chosen of its looks, where that was something.
    #[serde(skip_serializing_if = "Option::is_none")]
    style: Option<Style>,
    /// Frequencies along each axis for one of the scene.
    finer: usize,
    /// The hash of each scene with the photons of this quality, at its own frequencies.
    scenes: BTreeMap<&'a str, String>,
    photons: BTreeMap<&'a str, u64>,
    /// The user's scenes, as they were run but for the frequencies.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    scene_files: &'a BTreeMap<String, SceneFile>,
    planes: Vec<Judged<'a>>,
    files: &'a BTreeMap<String, String>,
}

#[derive(Debug, Serialize)]
struct Judged<'a> {
    scene: &'a str,
    plane: &'a str,
    verdict: Verdict,
    p_value: Option<f64>,
    chi2_per_dof: Option<f64>,
    high_frequency_share: &'a [HighFrequencyShare],
    /// Where the figure shows full radial spectra.
    #[serde(skip_serializing_if = "Option::is_none")]
    full_radial: Option<FullRadialReport>,
}

/// Makes a figure; returns the verdict on all planes of its scenes.
fn made(args: &FigureArgs, style: Option<Style>, subject: &Subject) -> Result<Verdict, Failure> {
    let endings = ["png", "svg", "pdf", "csv", "npz"].map(|end| format!("figure.{end}"));
    let texts = subject.texts.iter().map(|(name, _)| format!("{name}.ron"));
    let plan = Plan {
        index: FIGURE,
        files: endings.into_iter().chain(texts).collect(),
        inputs: subject.inputs.clone(),
        force: args.force.force,
    };
    let mut results = Results::claim_below(&args.out, &subject.name, plan)?;
    let files = subject.scenes.iter().filter(|_| subject.is_own);
    let files: BTreeMap<String, SceneFile> = files
        .map(|scene| (scene.name.clone(), scene.file.clone()))
        .collect();
    let shots = subject.scenes.iter();
    let take = |scene: &Scene| {
        let full_radial = subject.full_radial;
        Shot::take(scene.clone(), args.quality, full_radial, args.quiet)
    };
    let shots = shots.map(take);
    let shots: Vec<Shot> = shots.collect::<Result<_, _>>()?;
    let taken = Taken {
        shots: &shots,
        also: subject.also,
        planes: &subject.planes,
        quality: args.quality,
        style: style.unwrap_or_default(),
        quiet: args.quiet,
    };
    write(&mut results, subject, &taken)?;
    let all = shots.iter().enumerate().flat_map(|(i, shot)| {
        // Of a user's scenes those planes count that are shown.
        let shown = subject.planes.get(i);
        let reports = shot.planes.iter().map(|plane| &plane.report);
        let reports = reports.filter(move |report| shown.is_none_or(|name| *name == report.name));
        reports.map(move |report| (shot, report))
    });
    let all: Vec<_> = all.collect();
    let of_scenes = shots.iter().map(|shot| (shot.scene.name.as_str(), shot));
    let styled = args.style.iter();
    let styled = styled.map(|path| format!(" --style {}", shell_word(&path.to_string_lossy())));
    let styled: String = styled.collect();
    let finished = results.finish(|written| {
        let quality = args.quality.to_possible_value();
        let quality = quality.as_ref().map_or("", |value| value.get_name());
        let judged = all.iter().map(|(shot, report)| Judged {
            scene: &shot.scene.name,
            plane: &report.name,
            verdict: report.verdict,
            p_value: report.p_value,
            chi2_per_dof: report.chi2_per_dof,
            high_frequency_share: &report.high_frequency_share,
            full_radial: report.full_radial,
        });
        json(&Index {
            figure: &subject.name,
            about: &subject.about,
            command: format!(
                "etendue figure {}{styled} --quality {quality}",
                subject.arguments
            ),
            version: VERSION,
            quality: args.quality,
            style,
            finer: args.quality.finer(),
            photons: of_scenes
                .clone()
                .map(|(name, shot)| (name, shot.photons))
                .collect(),
            scenes: of_scenes
                .map(|(name, shot)| (name, shot.scene.hash()))
                .collect(),
            scene_files: &files,
            planes: judged.collect(),
            files: written,
        })
    })?;
    say_replaced(&finished, args.quiet);
    for (shot, report) in all.iter().filter(|_| !args.quiet) {
        if let Some(reason) = &report.undecided {
            say(&format!(
                "{}, {}: undecided: {reason}",
                shot.scene.name, report.name
            ));
        }
    }
    let verdicts = all.iter().map(|(_, report)| report.verdict);
    Ok(verdicts.fold(Verdict::Pass, Verdict::and))
}

/// The picture of a figure, what is behind it, and its scenes.
fn write(results: &mut Results, subject: &Subject, taken: &Taken<'_>) -> Result<(), Failure> {
    let figure = (subject.draw)(taken)?;
    let pdf = figure.pdf().map_err(Failure::cannot_run)?;
    let png = figure.png().map_err(Failure::cannot_run)?;
    results.write("figure.pdf", &pdf)?;
    results.write("figure.png", &png)?;
    results.write("figure.svg", figure.svg.as_bytes())?;
    // Strips have a row for each cell there, which the arrays hold in less.
    if subject.has_table {
        results.write("figure.csv", figure.csv.as_bytes())?;
    }
    if !taken.shots.is_empty() {
        results.write("figure.npz", &shot::arrays(taken.shots)?)?;
    }
    for (name, text) in &subject.texts {
        results.write(&format!("{name}.ron"), text.as_bytes())?;
    }
    Ok(())
}
