use crate::args::{Expect, RunArgs, Save};
use crate::failure::{CANNOT_RUN, Failure};
use crate::results::Results;
use crate::summary::{Stopwatch, Summary};
use crate::{files, load, photons, pictures, progress, table};
use etendue_compare::{PlaneComparison, Prediction, Verdict, compare, sidak};
use etendue_scene::Scene;
use etendue_spectrum::{Measurement, measure};
use etendue_trace::Tracer;
use std::path::{Path, PathBuf};

/// `etendue run`: returns the exit code.
pub(crate) fn run(args: &RunArgs) -> Result<u8, Failure> {
    let scene = load::scene(&args.scene, |run| {
        run.photons = args.photons.unwrap_or(run.photons);
        run.seed = args.seed.unwrap_or(run.seed);
    })?;
    let folder = args
        .out
        .clone()
        .unwrap_or_else(|| Path::new("out").join(&scene.name));
    let results = Results::create(&folder)?;
    ctrlc::set_handler(interrupted).map_err(Failure::cannot_run)?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(args.threads.unwrap_or(0).into())
        .build()
        .map_err(Failure::cannot_run)?;
    pool.install(|| measured_run(args, &scene, results))
}

/// Ends the process wherever it is: files are renamed into place whole, and the summary that would make the
/// folder a result comes last.
#[expect(clippy::print_stderr, clippy::exit, reason = "the user asked to stop")]
fn interrupted() {
    eprintln!("\ninterrupted: no result was written");
    std::process::exit(i32::from(CANNOT_RUN));
}

fn measured_run(args: &RunArgs, scene: &Scene, results: Results) -> Result<u8, Failure> {
    let mut watch = Stopwatch::start();
    let measurement = trace(scene, args.quiet);
    watch.lap("trace");

    let stage = progress::stage("predicting and comparing", args.quiet);
    let predictions: Vec<Prediction> = scene
        .planes
        .iter()
        .map(|plane| Prediction::new(scene, plane))
        .collect();
    watch.lap("predict");
    let planes = compared(scene, &measurement, &predictions)?;
    watch.lap("compare");
    stage.set_message("writing results");

    let summary = Summary::new(scene, &measurement, &planes);
    let folder = written(args, scene, results, &summary, &predictions, &planes, watch)?;
    stage.finish_and_clear();
    if !args.quiet {
        table::print(&summary, &folder);
    }
    let wanted = match args.expect {
        Some(Expect::Disagreement) => Verdict::Fail,
        None => Verdict::Pass,
    };
    Ok(u8::from(summary.verdict != wanted))
}

fn trace(scene: &Scene, quiet: bool) -> Measurement {
    let bar = progress::photons(scene.run.photons, quiet);
    let measurement = measure(
        &Tracer::new(scene),
        &scene.planes,
        0..scene.run.batches,
        &|photons| bar.inc(photons),
    );
    bar.finish_and_clear();
    measurement
}

fn compared(
    scene: &Scene,
    measurement: &Measurement,
    predictions: &[Prediction],
) -> Result<Vec<PlaneComparison>, Failure> {
    let level = sidak(scene.run.alpha, scene.planes.len());
    predictions
        .iter()
        .enumerate()
        .map(|(i, prediction)| {
            compare(measurement, i, prediction, level, scene.run.seed).map_err(Failure::cannot_run)
        })
        .collect()
}

/// Writes everything; the summary last.
fn written(
    args: &RunArgs,
    scene: &Scene,
    mut results: Results,
    summary: &Summary,
    predictions: &[Prediction],
    planes: &[PlaneComparison],
    mut watch: Stopwatch,
) -> Result<PathBuf, Failure> {
    results.begin()?;
    for (prediction, plane) in predictions.iter().zip(planes) {
        files::write(&mut results, summary, plane)?;
        pictures::plane(&mut results, summary, prediction, plane)?;
    }
    pictures::path(&mut results, summary, scene, planes)?;
    if args.save.contains(&Save::Photons) {
        photons::save(&mut results, scene, planes)?;
    }
    watch.lap("write");
    results.write_unlisted("timing.json", &watch.json(scene.run.photons))?;
    results.finish(|files| summary.json(files))
}
