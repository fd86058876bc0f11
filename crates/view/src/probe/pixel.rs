//! Probes the light field behind a pixel.

use super::covariance;
use super::found::{Found, verdict};
use super::picture::PictureBandwidth;
use super::scene::{ALPHA, BATCHES, ProbeRequest, ProbedScene, RESOLUTION};
use super::words::{lines, of_plane, of_stop};
use etendue_compare::{Prediction, Test, Verdict, compare, sidak};
use etendue_field::{PhotonSource, VirtualPlane};
use etendue_paths::{BackwardProbe, Budget, PhotonProbe, Probe};
use etendue_pipeline::{Reporter, Work};
use etendue_report::pictures;
use etendue_spectrum::bandwidth::{bandwidth_nu, bandwidth_rho};
use etendue_spectrum::{CrossPower, Measurement, WindowedMean, measure};
use etendue_store::sealed::json;
use etendue_store::{ArgumentStyle, Failure, Results, arrays};
use serde_json::json as tree_of;
use std::path::PathBuf;

/// The result of probing a pixel.
#[derive(Debug)]
pub struct ProbedPixel {
    /// The results folder.
    pub folder: PathBuf,
    /// The verdict on rays against photons.
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
    let files = probe.planes.iter().flat_map(|plane| files_of(&plane.name));
    let (results, folder) = scene.claim(format!("{name}-{column}-{row}"), files.collect())?;
    let found = measured(request, &probe, reporter)?;
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
    made_from["rays"] = tree_of!(scene.request.rays);
    for (plane, (found, photons)) in probe.planes.iter().zip(found) {
        arrays::write(&mut results, made_from.clone(), &found.comparison)?;
        let source = (note, ["backward rays", "photons"]);
        pictures::plane(&mut results, source, photons, plane, &found.comparison)?;
    }
    let each = found.iter().map(|(found, _)| verdict(found));
    let verdict = each.fold(Verdict::Pass, Verdict::and);
    let stops = probe.stops.iter();
    let stage = reporter.begin(Work::Stage("writing results"));
    let finished = results.finish(|files| {
        made_from["verdict"] = tree_of!(verdict);
        made_from["picture"] = picture.tree();
        made_from["surfaces"] = stops
            .map(|stop| of_stop(&scene.imported.world, stop))
            .collect();
        made_from["planes"] = found.iter().map(|(found, _)| of_plane(found)).collect();
        made_from["files"] = tree_of!(files);
        json(&made_from)
    })?;
    drop(stage);
    if let Some(message) = finished.replaced_message() {
        reporter.note(&message);
    }
    Ok(verdict)
}

fn files_of(name: &str) -> impl Iterator<Item = String> + use<'_> {
    let files = arrays::NAMES.into_iter().chain(pictures::NAMES);
    files.map(move |file| format!("{name}/{file}"))
}

/// Compares backward rays and photons at all planes.
fn measured(
    request: &ProbeRequest,
    probe: &Probe<'_>,
    reporter: &dyn Reporter,
) -> Result<Vec<(Found, Prediction)>, Failure> {
    let each = |count: u64| count.div_ceil(u64::from(BATCHES));
    let budget = |each| Budget {
        each,
        seed: request.seed,
    };
    let rays = BackwardProbe::new(probe, budget(each(request.rays)));
    let photons = PhotonProbe::new(
        probe,
        Budget {
            seed: !request.seed,
            ..budget(each(request.photons))
        },
    );
    let trace = |source: &dyn PhotonSource, count| -> Measurement {
        let bar = reporter.begin(Work::Photons(count));
        let found = measure(source, &probe.planes, 0..BATCHES, &|done| bar.advance(done));
        drop(bar);
        found
    };
    let backward = trace(&rays, request.rays);
    let forward = trace(&photons, request.photons);
    let test = Test {
        level: sidak(ALPHA, probe.planes.len()),
        resolution: RESOLUTION,
        seed: request.seed,
    };
    let plane = |i: usize| {
        let prediction = Prediction::measured(&forward, i).map_err(Failure::cannot_run)?;
        let comparison = compare(&backward, i, &prediction, &test).map_err(Failure::cannot_run)?;
        let VirtualPlane { window, grid, .. } = &probe.planes[i];
        let mean = WindowedMean::new(window, grid);
        let batches = backward.at_plane(i).map(|batch| &batch.slices);
        let varying = mean.removed_from_all(batches);
        let azimuths = 0..grid.azimuths;
        let power = CrossPower::of_replicates(&varying, azimuths).map_err(Failure::cannot_run)?;
        let found = Found {
            comparison,
            nu: power.bandwidth(bandwidth_nu),
            rho: power.bandwidth(bandwidth_rho),
            misses: photons.misses(i),
            covariance: None,
        };
        Ok((found, prediction))
    };
    let planes: Result<Vec<_>, Failure> = (0..probe.planes.len()).map(plane).collect();
    let mut planes = planes?;
    if request.covariance {
        let all = covariance::measured(probe, budget(each(request.rays)), reporter)?;
        for ((found, _), covariance) in planes.iter_mut().zip(all) {
            found.covariance = Some(covariance);
        }
    }
    Ok(planes)
}
