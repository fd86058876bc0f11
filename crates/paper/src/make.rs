//! Makes a figure: runs its scenes, draws it, and writes it with data and recipe.

use crate::quality::Quality;
use crate::recipe::{RECIPES, Recipe, named};
use crate::request::{FigureRequest, Wanted};
use crate::scene_run::Shot;
use crate::subject::{FigureData, Subject};
use crate::{data, style, user_figures};
use etendue_compare::{FullRadialReport, HighFrequencyShare, Verdict};
use etendue_figures::Style;
use etendue_pipeline::{Reporter, Work};
use etendue_report::table::word;
use etendue_report::{Stopwatch, shell_word};
use etendue_scene::{Scene, SceneFile};
use etendue_store::sealed::json;
use etendue_store::{ArgumentStyle, FIGURE, Failure, Plan, Results, VERSION};
use serde::Serialize;
use std::collections::BTreeMap;

/// The requested figures: figures of the paper, or a single figure of all scene files.
pub fn subjects(request: &FigureRequest) -> Result<Vec<Subject>, Failure> {
    let is_scene = |wanted: &Wanted| matches!(wanted, Wanted::Scene(_));
    if request.wanted.iter().any(is_scene) {
        Ok(vec![user_figures::subject(request)?])
    } else {
        of_paper(request)
    }
}

/// The requested figures of the paper.
fn of_paper(request: &FigureRequest) -> Result<Vec<Subject>, Failure> {
    let of_scenes = [
        ("set", !request.set.is_empty()),
        ("plane", request.plane.is_some()),
    ];
    if let Some((option, _)) = of_scenes.iter().find(|(_, given)| *given) {
        let message = match request.arguments {
            ArgumentStyle::Command => {
                format!(
                    "--{option} applies only to figures of scene files: etendue figure SCENE.ron"
                )
            }
            ArgumentStyle::Python => format!("{option} applies only to figures of scenes"),
        };
        return Err(Failure::bad_input(message));
    }
    let names = request.wanted.iter().filter_map(|wanted| match wanted {
        Wanted::PaperFigure(name) => Some(name.as_str()),
        Wanted::Scene(_) => None,
    });
    let is_all = names.clone().any(|name| name == "all");
    let recipes: Vec<&'static Recipe> = if is_all {
        RECIPES.iter().collect()
    } else {
        names.map(named).collect::<Result<_, _>>()?
    };
    let subjects = recipes.into_iter();
    subjects.map(|recipe| recipe.subject()).collect()
}

/// The content of `figure.json`, except for the hashes of the files.
#[derive(Debug, Serialize)]
struct FigureIndex<'a> {
    figure: &'a str,
    about: &'a str,
    /// The command that makes the figure again.
    command: String,
    version: &'a str,
    quality: Quality,
    /// The chosen style, if any.
    #[serde(skip_serializing_if = "Option::is_none")]
    style: Option<Style>,
    /// The factor by which the figure's frequencies along each axis are denser than the scene's
    /// frequencies.
    finer: usize,
    /// The hash of each scene, with the number of photons for this quality and the scene's own
    /// frequencies.
    scenes: BTreeMap<&'a str, String>,
    photons: BTreeMap<&'a str, u64>,
    /// The user's scenes as they were run, except for the frequencies.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    scene_files: &'a BTreeMap<String, SceneFile>,
    planes: Vec<SceneVerdict<'a>>,
    files: &'a BTreeMap<String, String>,
}

#[derive(Debug, Serialize)]
struct SceneVerdict<'a> {
    scene: &'a str,
    plane: &'a str,
    verdict: Verdict,
    p_value: Option<f64>,
    chi2_per_dof: Option<f64>,
    high_frequency_share: &'a [HighFrequencyShare],
    /// The comparison of the full radial spectra, if the figure shows them.
    #[serde(skip_serializing_if = "Option::is_none")]
    full_radial: Option<FullRadialReport>,
}

/// Makes figures and reports each to `reporter`; returns the verdict on all planes of their scenes.
pub fn make_all(
    request: &FigureRequest,
    subjects: &[Subject],
    reporter: &dyn Reporter,
) -> Result<Verdict, Failure> {
    let bar = reporter.begin(Work::Steps {
        verb: "drawing",
        total: subjects.len(),
        things: "figures",
    });
    let mut worst = Verdict::Pass;
    for subject in subjects {
        bar.name(subject.name());
        let mut watch = Stopwatch::start();
        let verdict = make(request, subject, reporter)?;
        watch.lap("figure");
        reporter.note(&format!(
            "figure {}: {}, {:.1} s: {}",
            subject.name(),
            word(verdict),
            watch.seconds("figure").unwrap_or_default(),
            subject.about
        ));
        worst = worst.and(verdict);
        bar.advance(1);
    }
    Ok(worst)
}

/// Makes a figure; returns the verdict on all planes of its scenes. Reports replaced files and
/// undecided planes.
#[expect(clippy::too_many_lines, reason = "the steps of one figure, in order")]
pub(crate) fn make(
    request: &FigureRequest,
    subject: &Subject,
    reporter: &dyn Reporter,
) -> Result<Verdict, Failure> {
    let style = request.style.as_deref().map(style::read).transpose()?;
    let endings = ["png", "svg", "pdf", "csv", "npz"].map(|end| format!("figure.{end}"));
    let endings = endings.into_iter().chain([data::DESCRIPTION.to_owned()]);
    let texts = subject.texts.iter().map(|(name, _)| format!("{name}.ron"));
    let plan = Plan {
        index: FIGURE,
        files: endings.chain(texts).collect(),
        inputs: subject.inputs.clone(),
        force: request.force,
        arguments: request.arguments,
    };
    let mut results = Results::claim_below(&request.out, &subject.name, plan)?;
    let files = subject.scenes.iter().filter(|_| subject.is_own);
    let files: BTreeMap<String, SceneFile> = files
        .map(|scene| (scene.name.clone(), scene.file.clone()))
        .collect();
    let shots = subject.scenes.iter();
    let take = |scene: &Scene| {
        let full_radial = subject.full_radial;
        Shot::take(scene.clone(), request.quality, full_radial, reporter)
    };
    let shots = shots.map(take);
    let shots: Vec<Shot> = shots.collect::<Result<_, _>>()?;
    let taken = FigureData {
        shots: &shots,
        also: subject.also,
        planes: &subject.planes,
        quality: request.quality,
        style: style.unwrap_or_default(),
        reporter,
    };
    write(&mut results, subject, &taken)?;
    let all = shots.iter().enumerate().flat_map(|(i, shot)| {
        // For a user's scenes, only the planes that the figure shows are included.
        let shown = subject.planes.get(i);
        let reports = shot.planes.iter().map(|plane| &plane.report);
        let reports = reports.filter(move |report| shown.is_none_or(|name| *name == report.name));
        reports.map(move |report| (shot, report))
    });
    let all: Vec<_> = all.collect();
    let of_scenes = shots.iter().map(|shot| (shot.scene.name.as_str(), shot));
    let styled = request.style.iter();
    let styled = styled.map(|path| format!(" --style {}", shell_word(&path.to_string_lossy())));
    let styled: String = styled.collect();
    let finished = results.finish(|written| {
        let quality = request.quality.name();
        let judged = all.iter().map(|(shot, report)| SceneVerdict {
            scene: &shot.scene.name,
            plane: &report.name,
            verdict: report.verdict,
            p_value: report.p_value,
            chi2_per_dof: report.chi2_per_dof,
            high_frequency_share: &report.high_frequency_share,
            full_radial: report.full_radial,
        });
        json(&FigureIndex {
            figure: &subject.name,
            about: &subject.about,
            command: format!(
                "etendue figure {}{styled} --quality {quality}",
                subject.arguments
            ),
            version: VERSION,
            quality: request.quality,
            style,
            finer: request.quality.finer(),
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
    if let Some(message) = finished.replaced_message() {
        reporter.note(&message);
    }
    for (shot, report) in &all {
        if let Some(reason) = &report.undecided {
            reporter.note(&format!(
                "{}, {}: undecided: {reason}",
                shot.scene.name, report.name
            ));
        }
    }
    let verdicts = all.iter().map(|(_, report)| report.verdict);
    Ok(verdicts.fold(Verdict::Pass, Verdict::and))
}

/// Writes the picture of a figure, the numbers behind it, and its scenes.
fn write(results: &mut Results, subject: &Subject, taken: &FigureData<'_>) -> Result<(), Failure> {
    let figure = taken.style.within_height(|style| {
        (subject.draw)(&FigureData {
            style: *style,
            ..*taken
        })
    })?;
    let pdf = figure.pdf().map_err(Failure::cannot_run)?;
    let png = figure.png().map_err(Failure::cannot_run)?;
    let _stage = taken.reporter.begin(Work::Stage("writing results"));
    results.write("figure.pdf", &pdf)?;
    results.write("figure.png", &png)?;
    results.write("figure.svg", figure.svg.as_bytes())?;
    for (name, bytes) in data::files(&figure, taken.shots)? {
        results.write(name, &bytes)?;
    }
    for (name, text) in &subject.texts {
        results.write(&format!("{name}.ron"), text.as_bytes())?;
    }
    Ok(())
}
