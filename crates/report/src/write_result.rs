//! Writes the result of a run: arrays, pictures and the page, and then the summary.

use crate::{Stopwatch, explorer, page, pictures};
use etendue_field::{VirtualPlane, byte_size};
use etendue_pipeline::photons::Save;
use etendue_pipeline::{Judged, MeasuredScene, Outcome, field, photons};
use etendue_scene::Scene;
use etendue_store::stored::check_earlier;
use etendue_store::{ArgumentStyle, Failure, Finished, Plan, Results, SUMMARY, TIMING, arrays};
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// The user's options for a result folder.
#[derive(Debug)]
pub struct OutputOptions<'a> {
    /// The data saved beside the result.
    pub save: &'a [Save],
    /// Whether to omit files whose content is also in other files.
    pub compact: bool,
}

/// Suffixes of files that a compact result omits, because `report.html` shows the drawings and
/// arrays hold the numbers.
const NOT_COMPACT: &[&str] = &[".csv", ".svg"];

/// Fails if the explorer is to be saved and does not support the scene.
pub fn check_explorer(scene: &Scene, save: &[Save]) -> Result<(), Failure> {
    if save.contains(&Save::Explorer) && explorer::fragment(&scene.file).is_none() {
        return Err(Failure::bad_input(
            "--save explorer: the explorer shows only scenes that it could have saved",
        ));
    }
    Ok(())
}

/// The files that a comparison of a scene writes.
pub fn plan(
    scene: &Scene,
    save: &[Save],
    inputs: Vec<PathBuf>,
    force: bool,
    arguments: ArgumentStyle,
) -> Plan {
    let of_plane = |plane: &VirtualPlane| {
        let mut names = [arrays::NAMES.as_slice(), pictures::NAMES.as_slice()].concat();
        names.extend(save.iter().flat_map(|save| photons::names(*save)));
        if save.contains(&Save::Field) {
            names.extend(field::NAMES);
        }
        let path = |name| format!("{}/{name}", plane.name);
        names.into_iter().map(path).collect::<Vec<_>>()
    };
    let beside = pictures::PATH_NAMES
        .into_iter()
        .chain([TIMING, page::NAME])
        .chain(save.contains(&Save::Explorer).then_some(explorer::NAME));
    let saved = save
        .iter()
        .map(|save| photons::of_scene(*save, &scene.planes));
    Plan {
        index: SUMMARY,
        files: scene
            .planes
            .iter()
            .flat_map(of_plane)
            .chain(beside.map(str::to_owned))
            .chain(saved.flatten())
            .collect(),
        inputs,
        force,
        arguments,
    }
}

/// Describes the largest possible size of the files, which is reached if every photon crosses
/// every plane.
pub fn announcement(scene: &Scene, save: Save) -> Option<String> {
    let (_, row) = photons::file_of(save)?;
    let planes = scene.planes.len();
    let each = row * scene.run.photons;
    let [all, each] = [each * planes as u64, each].map(|bytes| byte_size(bytes as f64));
    Some(format!(
        "--save {}: at most {all} on disk, {each} for each of {planes} planes",
        save.name()
    ))
}

/// Writes all files, with the summary last.
pub fn write_result(
    case: &MeasuredScene,
    options: &OutputOptions<'_>,
    mut results: Results,
    Judged { planes, summary }: &Judged,
    mut watch: Stopwatch,
) -> Result<Finished, Failure> {
    if options.compact {
        results.leave_out(NOT_COMPACT);
    }
    let made_from = pictures::made_from(summary);
    let drawn = |((prediction, plane), at)| {
        pictures::plane((&made_from, pictures::sides(plane)), prediction, at, plane)
    };
    let each = case.predictions.par_iter().zip(planes);
    let each = each.zip(&case.scene.planes);
    let (path, of_planes) = rayon::join(
        || pictures::path(case, planes),
        || each.map(drawn).collect::<Result<Vec<_>, _>>(),
    );
    for (plane, pictures) in planes.iter().zip(of_planes?) {
        arrays::write(&mut results, summary.made_from(), plane)?;
        pictures
            .iter()
            .try_for_each(|files| files.write(&mut results))?;
    }
    let path = path?;
    path.write(&mut results)?;
    let explorer = explorer::fragment(&summary.scene_file);
    let explorer = explorer.filter(|_| options.save.contains(&Save::Explorer));
    let data = page::data(case, summary, planes, (path.svg(), explorer.as_deref()));
    results.write(
        page::NAME,
        page::page(&case.scene.name, &[(String::new(), data)]).as_bytes(),
    )?;
    if explorer.is_some() {
        results.write(explorer::NAME, explorer::PAGE)?;
    }
    for save in options.save {
        photons::save(&mut results, case, *save)?;
    }
    watch.lap("write");
    results.write_unlisted(TIMING, &watch.json(summary.photons))?;
    results.finish(|files| summary.json(files))
}

/// Writes the files of `etendue run`; returns the folder. `arguments` is the style in which
/// messages name `force`.
///
/// # Errors
/// When the folder holds another scene's result and `force` is not set, or when it cannot be
/// written.
pub fn save(
    outcome: &Outcome,
    folder: &Path,
    force: bool,
    arguments: ArgumentStyle,
) -> Result<PathBuf, Failure> {
    let scene = &outcome.case.scene;
    check_earlier(folder, SUMMARY, scene, force, arguments)?;
    let inputs = outcome.inputs.clone();
    let plan = plan(scene, &[], inputs, force, arguments);
    let results = Results::claim(folder, plan)?;
    let options = OutputOptions {
        save: &[],
        compact: false,
    };
    let watch = Stopwatch::start();
    let finished = write_result(&outcome.case, &options, results, &outcome.judged, watch)?;
    Ok(finished.folder)
}
