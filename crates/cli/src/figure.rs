//! `etendue figure`: the figures of Durand et al. 2005, made anew from measurement and theory.

mod criteria;
mod kernels;
mod plates;
mod recipe;
mod rows;
mod shading;
mod shot;
mod spaces;
mod table1;

use crate::args::FigureArgs;
use crate::failure::Failure;
use crate::results::sealed::json;
use crate::results::stored::VERSION;
use crate::results::{FIGURE, Plan, Results};
use crate::threads::on_threads;
use crate::{progress, say};
use clap::ValueEnum;
use etendue_compare::{HighFrequencyShare, Verdict};
use recipe::{RECIPES, Recipe, Taken};
use serde::Serialize;
use shot::Shot;
use std::collections::BTreeMap;
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

/// `etendue figure`: returns the exit code.
pub(crate) fn figure(args: &FigureArgs) -> Result<u8, Failure> {
    let recipes: Vec<&Recipe> = match args.name.as_str() {
        "all" => RECIPES.iter().collect(),
        name => vec![recipe::named(name)?],
    };
    on_threads(&args.threads, || {
        let bar = progress::steps("drawing", recipes.len(), "figures", args.quiet);
        let mut worst = Verdict::Pass;
        for recipe in recipes {
            bar.set_message(recipe.name);
            let begun = Instant::now();
            let verdict = bar.suspend(|| made(args, recipe))?;
            if !args.quiet {
                let (name, seconds) = (recipe.name, begun.elapsed().as_secs_f64());
                let verdict = crate::table::word(verdict);
                let line = format!("figure {name}: {verdict}, {seconds:.1} s: {}", recipe.about);
                bar.suspend(|| say(&line));
            }
            worst = worst.and(verdict);
            bar.inc(1);
        }
        bar.finish_and_clear();
        if !args.quiet {
            say(&format!("figures in {}", args.out.display()));
        }
        Ok(match worst {
            Verdict::Pass => 0,
            Verdict::Fail => 1,
            Verdict::Undecided => 4,
        })
    })
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
    /// Frequencies along each axis for one of the scene.
    finer: usize,
    /// The hash of each scene with the photons of this quality, at its own frequencies.
    scenes: BTreeMap<&'a str, String>,
    photons: BTreeMap<&'a str, u64>,
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
}

/// Makes a figure; returns the verdict on all planes of its scenes.
fn made(args: &FigureArgs, recipe: &Recipe) -> Result<Verdict, Failure> {
    let endings = ["png", "svg", "pdf", "csv", "npz"].map(|end| format!("figure.{end}"));
    let scenes = recipe.texts().map(|(name, _)| format!("{name}.ron"));
    let plan = Plan {
        index: FIGURE,
        files: endings.into_iter().chain(scenes).collect(),
        inputs: Vec::new(),
        force: args.force.force,
    };
    let mut results = Results::claim(&args.out.join(recipe.name), plan)?;
    let shots = recipe.scenes.iter();
    let shots = shots.map(|(name, text)| Shot::take(name, text, args.quality, args.quiet));
    let shots: Vec<Shot> = shots.collect::<Result<_, _>>()?;
    write(&mut results, recipe, args, &shots)?;
    let all = shots
        .iter()
        .flat_map(|shot| shot.planes.iter().map(move |plane| (shot, plane)));
    let all: Vec<_> = all.map(|(shot, plane)| (shot, &plane.report)).collect();
    let finished = results.finish(|files| {
        let quality = args.quality.to_possible_value();
        let quality = quality.as_ref().map_or("", |value| value.get_name());
        let judged = all.iter().map(|(shot, report)| Judged {
            scene: &shot.scene.name,
            plane: &report.name,
            verdict: report.verdict,
            p_value: report.p_value,
            chi2_per_dof: report.chi2_per_dof,
            high_frequency_share: &report.high_frequency_share,
        });
        json(&Index {
            figure: recipe.name,
            about: recipe.about,
            command: format!("etendue figure {} --quality {quality}", recipe.name),
            version: VERSION,
            quality: args.quality,
            finer: args.quality.finer(),
            photons: shots
                .iter()
                .map(|shot| (shot.scene.name.as_str(), shot.photons))
                .collect(),
            scenes: shots
                .iter()
                .map(|s| (s.scene.name.as_str(), s.scene.hash()))
                .collect(),
            planes: judged.collect(),
            files,
        })
    })?;
    finished.tell_replaced(args.quiet);
    let verdicts = all.iter().map(|(_, report)| report.verdict);
    Ok(verdicts.fold(Verdict::Pass, Verdict::and))
}

/// The picture of a figure, what is behind it, and its scenes.
fn write(
    results: &mut Results,
    recipe: &Recipe,
    args: &FigureArgs,
    shots: &[Shot],
) -> Result<(), Failure> {
    let figure = (recipe.draw)(&Taken {
        shots,
        also: recipe.also,
        quality: args.quality,
        quiet: args.quiet,
    })?;
    let pdf = figure.pdf().map_err(Failure::cannot_run)?;
    let png = figure.png().map_err(Failure::cannot_run)?;
    results.write("figure.pdf", &pdf)?;
    results.write("figure.png", &png)?;
    results.write("figure.svg", figure.svg.as_bytes())?;
    // Strips have a row for each cell there, which the arrays hold in less.
    if recipe.has_table {
        results.write("figure.csv", figure.csv.as_bytes())?;
    }
    if !shots.is_empty() {
        results.write("figure.npz", &shot::arrays(shots)?)?;
    }
    for (name, text) in recipe.texts() {
        results.write(&format!("{name}.ron"), text.as_bytes())?;
    }
    Ok(())
}
