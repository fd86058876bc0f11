//! Probes the light field behind a pixel.

use super::covariance;
use super::found::{Found, SecondEstimate, verdict};
use super::picture::PictureBandwidth;
use super::scene::{ALPHA, BATCHES, ProbeRequest, ProbedScene, RESOLUTION};
use super::words::{lines, of_plane, of_stop};
use etendue_compare::{PlaneComparison, Prediction, Test, Verdict, compare, sidak};
use etendue_field::PhotonSource;
use etendue_paths::{BackwardProbe, Budget, PhotonProbe, Probe};
use etendue_pipeline::{Reporter, Work};
use etendue_report::pictures;
use etendue_spectrum::bandwidth::{bandwidth_nu, bandwidth_rho};
use etendue_spectrum::{CrossPower, Measurement, measure};
use etendue_store::sealed::json;
use etendue_store::{ArgumentStyle, Failure, Results, arrays};
use serde_json::json as tree_of;
use std::path::PathBuf;

/// Rays that find lights only by directions sampled from BSDFs have more noise than backward rays.
/// Therefore their number is larger by this factor.
const BSDF_RAYS: u64 = 4;
/// The difference between the seed of these rays and the seed of the backward rays.
const BSDF_SEED: u64 = 1 << 63;

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
        let source = (note, ["backward rays", found.judge.word()]);
        pictures::plane(&mut results, source, photons, plane, &found.comparison)?;
    }
    let each = found
        .iter()
        .map(|(found, _)| found.comparison.report.verdict);
    let verdict = each.fold(Verdict::Pass, Verdict::and);
    let stops = probe.stops.iter();
    let stage = reporter.begin(Work::Stage("writing results"));
    let finished = results.finish(|files| {
        made_from["verdict"] = tree_of!(verdict);
        made_from["picture"] = picture.tree();
        made_from["surfaces"] = stops
            .map(|stop| of_stop(&scene.imported.world, stop))
            .collect();
        made_from["batches"] = tree_of!(BATCHES);
        let planes = found.iter().zip(&probe.planes);
        made_from["planes"] = planes
            .map(|((found, _), plane)| of_plane(found, plane))
            .collect();
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

/// The measurements of a probe, and the test that compares them.
struct Comparisons<'a> {
    probe: &'a Probe<'a>,
    backward: Measurement,
    test: Test,
}

impl Comparisons<'_> {
    /// Compares backward rays with another measurement of the same light at a plane.
    fn at_plane(
        &self,
        i: usize,
        other: &Measurement,
    ) -> Result<(PlaneComparison, Prediction), Failure> {
        let prediction = Prediction::measured(other, i).map_err(Failure::cannot_run)?;
        let comparison =
            compare(&self.backward, i, &prediction, &self.test).map_err(Failure::cannot_run)?;
        Ok((comparison, prediction))
    }

    /// Returns the results at a plane with their comparison.
    fn found(
        &self,
        i: usize,
        comparison: PlaneComparison,
        misses: Option<&'static str>,
    ) -> Result<Found, Failure> {
        let varying = self.backward.without_mean(i);
        let azimuths = 0..self.probe.planes[i].grid.azimuths;
        let power = CrossPower::of_replicates(&varying, azimuths).map_err(Failure::cannot_run)?;
        Ok(Found {
            comparison,
            nu: power.bandwidth(bandwidth_nu),
            rho: power.bandwidth(bandwidth_rho),
            judge: SecondEstimate::Photons,
            misses,
            covariance: None,
        })
    }
}

/// Compares backward rays and photons at all planes. If a plane is then undecided, compares the
/// backward rays with rays that find lights only by directions sampled from BSDFs.
fn measured(
    request: &ProbeRequest,
    probe: &Probe<'_>,
    reporter: &dyn Reporter,
) -> Result<Vec<(Found, Prediction)>, Failure> {
    let budget = |count: u64, seed| Budget {
        each: count.div_ceil(u64::from(BATCHES)),
        seed,
    };
    let rays = BackwardProbe::new(probe, budget(request.rays, request.seed));
    let photons = PhotonProbe::new(probe, budget(request.photons, !request.seed));
    let trace = |source: &dyn PhotonSource, count| -> Measurement {
        let bar = reporter.begin(Work::Photons(count));
        let found = measure(source, &probe.planes, 0..BATCHES, &|done| bar.advance(done));
        drop(bar);
        found
    };
    let comparisons = Comparisons {
        probe,
        backward: trace(&rays, request.rays),
        test: Test {
            // Each plane has up to two tests.
            level: sidak(ALPHA, 2 * probe.planes.len()),
            resolution: RESOLUTION,
            seed: request.seed,
        },
    };
    let forward = trace(&photons, request.photons);
    let mut planes = Vec::new();
    for i in 0..probe.planes.len() {
        let (comparison, prediction) = comparisons.at_plane(i, &forward)?;
        let found = comparisons.found(i, comparison, photons.misses(i))?;
        planes.push((found, prediction));
    }
    let open = (0..planes.len()).filter(|i| verdict(&planes[*i].0) == Verdict::Undecided);
    for i in open.collect::<Vec<usize>>() {
        let seed = request.seed.wrapping_add(BSDF_SEED);
        let rays = BackwardProbe::new(probe, budget(BSDF_RAYS * request.rays, seed)).at_plane(i);
        let Some(rays) = rays.by_bsdf() else {
            break;
        };
        let found = trace(&rays, BSDF_RAYS * request.rays);
        let (comparison, prediction) = comparisons.at_plane(i, &found)?;
        let (plane, old) = &mut planes[i];
        let noise = |of: &PlaneComparison| of.report.noise_limit.unwrap_or(f64::INFINITY);
        if plane.misses.is_some() || noise(&comparison) < noise(&plane.comparison) {
            plane.comparison = comparison;
            plane.judge = SecondEstimate::BsdfRays;
            *old = prediction;
        }
    }
    for (found, _) in &mut planes {
        found.comparison.report.verdict = verdict(found);
    }
    if request.covariance {
        let all = covariance::measured(probe, budget(request.rays, request.seed), reporter)?;
        for ((found, _), covariance) in planes.iter_mut().zip(all) {
            found.covariance = Some(covariance);
        }
    }
    Ok(planes)
}
