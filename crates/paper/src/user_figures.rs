//! Draws figures of the user's scenes. A single scene is shown along its path, and several scenes
//! are shown side by side at a plane.

use crate::request::{FigureRequest, Wanted};
use crate::rows::{compared, feet};
use crate::subject::{FigureData, Subject};
use etendue_field::grouped;
use etendue_figures::{Figure, Plate};
use etendue_pipeline::limits;
use etendue_pipeline::load::{self, SceneSource};
use etendue_report::pictures::{Seen, spectra_are};
use etendue_report::shell_word;
use etendue_report::table::spaced;
use etendue_scene::Scene;
use etendue_store::Failure;
use std::path::PathBuf;

/// The figure of the requested scenes.
pub(crate) fn subject(request: &FigureRequest) -> Result<Subject, Failure> {
    let sources = sources(request)?;
    let mut scenes: Vec<Scene> = Vec::new();
    let mut inputs: Vec<PathBuf> = Vec::new();
    let mut warnings: Vec<String> = Vec::new();
    for source in &sources {
        let found = load::scene(source, |_| ())?;
        limits::check_one_light(&found, "a figure")?;
        if scenes.iter().any(|scene| scene.name == found.name) {
            let message = format!(
                "two scenes are named {}: give one file another name",
                found.name
            );
            return Err(Failure::bad_input(message));
        }
        warnings.extend(found.warnings());
        inputs.extend(load::inputs(source, &found));
        scenes.push(found);
    }
    let planes = planes(&scenes, request.plane.as_deref())?;
    let names: Vec<&str> = scenes.iter().map(|scene| scene.name.as_str()).collect();
    let at = request
        .plane
        .as_ref()
        .map_or(String::new(), |plane| format!("-{plane}"));
    let (name, listed) = (names.join("-") + &at, names.join(", "));
    let about = if planes.is_empty() {
        format!("the light field along the path of {listed}")
    } else {
        format!("{listed} at {}", joined(&planes))
    };
    Ok(Subject {
        name,
        about,
        arguments: arguments(request, &sources),
        scenes,
        is_own: true,
        texts: Vec::new(),
        inputs,
        warnings,
        full_radial: false,
        also: &[],
        draw: if planes.is_empty() {
            |taken| taken.strip()
        } else {
            side_by_side
        },
        planes,
    })
}

/// Returns the requested scenes, and fails if figures of the paper are also requested.
fn sources(request: &FigureRequest) -> Result<Vec<&SceneSource>, Failure> {
    let sources = request.wanted.iter().map(|wanted| match wanted {
        Wanted::Scene(source) => Ok(source),
        Wanted::PaperFigure(name) => Err(Failure::bad_input(format!(
            "{name} is not a scene file: scene files are drawn as one figure, without figures of the paper"
        ))),
    });
    sources.collect()
}

/// The plane at which each scene is shown; empty if all planes of a single scene are
/// shown.
fn planes(scenes: &[Scene], asked: Option<&str>) -> Result<Vec<String>, Failure> {
    if scenes.len() == 1 && asked.is_none() {
        return Ok(Vec::new());
    }
    let plane = |scene: &Scene| {
        let names: Vec<&str> = scene
            .planes
            .iter()
            .map(|plane| plane.name.as_str())
            .collect();
        let name = asked.or(names.last().copied()).unwrap_or_default();
        if names.contains(&name) {
            return Ok(name.to_owned());
        }
        let message = format!(
            "{} has no plane {name}; it has {}",
            scene.name,
            names.join(", ")
        );
        Err(Failure::bad_input(message))
    };
    scenes.iter().map(plane).collect()
}

/// Arguments of `etendue figure` that make the figure again.
fn arguments(request: &FigureRequest, sources: &[&SceneSource]) -> String {
    let names = sources.iter().map(|source| match source.text {
        Some(_) => source
            .path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy(),
        None => source.path.to_string_lossy(),
    });
    let mut words: Vec<String> = names.map(|name| shell_word(&name)).collect();
    for (path, value) in &request.set {
        words.extend(["--set".to_owned(), shell_word(&format!("{path}={value}"))]);
    }
    if let Some(plane) = &request.plane {
        words.extend(["--plane".to_owned(), shell_word(plane)]);
    }
    words.join(" ")
}

/// A plane of each scene, with one range of colors.
fn side_by_side(taken: &FigureData<'_>) -> Result<Figure, Failure> {
    let seen = taken.shots.iter().zip(taken.planes);
    let seen: Vec<Seen<'_>> = seen
        .map(|(shot, plane)| shot.at(plane))
        .collect::<Result<_, _>>()?;
    let heads = taken.shots.iter().map(|shot| spaced(&shot.scene.name));
    let photons = taken.shots.iter().map(|shot| grouped(shot.photons));
    let note = format!(
        "{} photons; spectra are {}.",
        joined(&photons.collect::<Vec<_>>()),
        spectra_are(seen.iter().map(|seen| seen.plane))
    );
    taken.plate(&Plate {
        title: &joined(taken.planes),
        note: &note,
        heads: heads.collect(),
        rows: compared(&seen, true),
        feet: feet(&seen),
        ..Plate::default()
    })
}

/// Joins distinct words, in their order, to an enumeration in a sentence.
fn joined(words: &[String]) -> String {
    let mut words: Vec<String> = words.iter().map(|word| spaced(word)).collect();
    words.dedup();
    words.join(", ")
}
