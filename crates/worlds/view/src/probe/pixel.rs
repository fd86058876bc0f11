//! Probes the light field behind a pixel.

use super::covariance;
use super::estimates::measured;
use super::found::Found;
use super::picture::PictureBandwidth;
use super::scene::{BATCHES, ProbeRequest, ProbedScene};
use super::variance;
use super::words::{lines, of_plane, of_stop};
use crate::world_source::finish;
use etendue_compare::{Prediction, Verdict};
use etendue_paths::Probe;
use etendue_pipeline::{Reporter, Work};
use etendue_report::pictures::{self, PictureFiles};
use etendue_store::{ArgumentStyle, Failure, Results, arrays};
use serde_json::json as tree_of;
use std::path::PathBuf;

/// The result of probing a pixel.
#[derive(Debug)]
pub struct ProbedPixel {
    /// The results folder.
    pub folder: PathBuf,
    /// The verdict of the comparison of rays with photons.
    pub verdict: Verdict,
    /// Surfaces, planes and bandwidths, line by line.
    pub lines: Vec<String>,
}

/// Probes the light field behind one pixel.
pub fn probe_pixel(
    request: &ProbeRequest,
    pixel: [usize; 2],
    reporter: &dyn Reporter,
) -> Result<ProbedPixel, Failure> {
    let scene = ProbedScene::read(request)?;

    let [[column, row], [w, h]] = [pixel, scene.camera.size];
    if column >= w || row >= h {
        let [w, h] = [w - 1, h - 1];
        return Err(Failure::bad_input(match request.source.arguments {
            ArgumentStyle::Command => {
                format!("--pixel {column},{row}; allowed: 0,0 to {w},{h}")
            }
            ArgumentStyle::Python => {
                format!("pixel is ({column}, {row}); allowed: (0, 0) to ({w}, {h})")
            }
        }));
    }
    let nothing = || {
        Failure::bad_input(
            "the ray through this pixel meets nothing, or the camera is orthographic",
        )
    };
    let bar = reporter.begin(Work::Photons(request.rays));
    let picture = PictureBandwidth::new(&scene, pixel, request.seed, &|done| bar.advance(done))?;
    drop(bar);
    let picture = picture.ok_or_else(nothing)?;
    let question = scene.question(pixel, picture.pixels, 4);
    let probe = Probe::new(&scene.paths, &scene.camera, &question).ok_or_else(nothing)?;
    let name = scene.name();
    let drawn = request.variance.is_some();
    let files = probe.planes.iter();
    let files = files.flat_map(|plane| files_of(&plane.name, drawn));
    let (results, folder) = scene.claim(format!("{name}-{column}-{row}"), files.collect())?;
    let mut found = measured(request, &probe, reporter)?;
    if request.covariance {
        let all = covariance::measured(&probe, request, reporter)?;
        for ((found, _), covariance) in found.iter_mut().zip(all) {
            found.covariance = Some(covariance);
        }
    }
    if let Some(options) = &request.variance {
        let dark: Vec<bool> = found.iter().map(|(found, _)| found.is_dark()).collect();
        let all = variance::studied(request, options, (&probe, &dark), reporter)?;
        for ((found, _), variance) in found.iter_mut().zip(all) {
            found.variance = variance;
        }
    }
    let note = format!("{name}, pixel {column}, {row}");
    let seen = (&probe, &picture, &found[..]);
    let verdict = written(&scene, results, (&note, pixel), seen, reporter)?;
    let found: Vec<&Found> = found.iter().map(|(found, _)| found).collect();
    Ok(ProbedPixel {
        folder,
        verdict,
        lines: lines(request, &scene.imported.world, (&probe, &picture), &found),
    })
}

/// Writes all files; returns the verdict.
fn written(
    scene: &ProbedScene<'_>,
    mut results: Results,
    (note, pixel): (&str, [usize; 2]),
    (probe, picture, found): (&Probe<'_>, &PictureBandwidth, &[(Found, Prediction)]),
    reporter: &dyn Reporter,
) -> Result<Verdict, Failure> {
    let mut made_from = scene.made_from();
    made_from["pixel"] = tree_of!(pixel);
    for (plane, (found, photons)) in probe.planes.iter().zip(found) {
        let mut made_from = made_from.clone();
        made_from["rays"] = tree_of!(found.counts[0]);
        arrays::write(&mut results, made_from, &found.comparison)?;
        let source = (note, ["backward rays", found.judge.word()]);
        let pictures = pictures::plane(source, photons, plane, &found.comparison)?;
        pictures
            .iter()
            .try_for_each(|files| files.write(&mut results))?;
        if let Some(found) = &found.variance {
            let figure = etendue_studies::variance::figure::drawn(note, found)?;
            PictureFiles::new(format!("{}/variance", plane.name), figure)?.write(&mut results)?;
        }
    }
    let each = found
        .iter()
        .map(|(found, _)| found.comparison.report.verdict);
    let verdict = each.fold(Verdict::Pass, Verdict::and);
    let stage = reporter.begin(Work::Stage("writing results"));
    made_from["rays"] = tree_of!(scene.request.rays);
    made_from["photons"] = tree_of!(scene.request.photons);
    made_from["verdict"] = tree_of!(verdict);
    made_from["picture"] = picture.tree();
    let stops = probe.stops.iter();
    made_from["surfaces"] = stops
        .map(|stop| of_stop(&scene.imported.world, stop))
        .collect();
    made_from["batches"] = tree_of!(BATCHES);
    let planes = found.iter().zip(&probe.planes);
    made_from["planes"] = planes
        .map(|((found, _), plane)| of_plane(scene.request, found, plane))
        .collect();
    finish(results, made_from, Some(stage), reporter)?;
    Ok(verdict)
}

fn files_of(name: &str, with_variance: bool) -> impl Iterator<Item = String> + use<'_> {
    let files = arrays::NAMES.into_iter().chain(pictures::NAMES);
    let drawn = etendue_studies::variance::figure::NAMES.into_iter();
    let files = files.chain(drawn.filter(move |_| with_variance));
    files.map(move |file| format!("{name}/{file}"))
}
