//! Implements `etendue covariance`, which shows covariance tracing beside the measured spectra of
//! a scene.

mod table;

use crate::args::CovarianceArgs;
use crate::planes;
use crate::print::{deliver, say_replaced};
use crate::progress;
use crate::progress::Terminal;
use crate::threads::on_threads;
use etendue_compare::{Applicability, CovarianceReport, Prediction, SliceMoment};
use etendue_field::PhotonSource;
use etendue_figures::{AxisQuantity, Ellipse, Ellipses, Picture, ellipses};
use etendue_pipeline::measured;
use etendue_pipeline::method::source;
use etendue_pipeline::moments::{check_memory, fitting};
use etendue_pipeline::predicted;
use etendue_pipeline::table::{grouped, spaced};
use etendue_pipeline::{limits, load, method};
use etendue_report::pictures;
use etendue_scene::Scene;
use etendue_spectrum::field::measure_field;
use etendue_spectrum::{CrossPower, Measurement};
use etendue_store::Failure;
use etendue_store::VERSION;
use etendue_store::sealed::json;
use etendue_store::{ArgumentStyle, COVARIANCE, Plan, Results};
use serde_json::json as tree_of;

/// The files written for each plane: a picture in two formats, and the data of this picture.
const NAMES: [&str; 3] = ["covariance.png", "covariance.svg", "covariance.csv"];

/// Runs `etendue covariance`; returns the exit code.
#[expect(clippy::too_many_lines, reason = "the steps of one command, in order")]
pub(crate) fn covariance(args: &CovarianceArgs) -> Result<u8, Failure> {
    let mut scene = load::scene(&args.scene.source(), |run| args.photons.set(run))?;
    choose(&mut scene, &args.plane)?;
    let theories = Applicability::of_planes(&scene);
    method::check(&scene, args.photons.method)?;
    let folder = args.out.or_named(format!("{}-covariance", scene.name));
    let planes = scene.planes.iter();
    let files = planes.flat_map(|plane| NAMES.map(|file| format!("{}/{file}", plane.name)));
    let plan = Plan {
        index: COVARIANCE,
        files: files.collect(),
        inputs: load::inputs(&args.scene.source(), &scene),
        force: args.work.force.force,
        arguments: ArgumentStyle::Command,
    };
    let (results, reports) = on_threads(&args.work.threads, || {
        limits::check(&scene, &theories, rayon::current_num_threads())?;
        check_memory(&scene.planes)?;
        let mut results = Results::claim(&folder, plan.clone())?;
        let method = args.photons.method;
        let measurement = measured(
            &scene,
            method,
            0..scene.run.batches,
            &Terminal::new(args.work.quiet),
        )?;
        let predictions = predicted(
            &scene,
            &theories,
            method,
            None,
            &Terminal::new(args.work.quiet),
        )?;
        let source = source(&scene, method)?;
        let mut reports = Vec::new();
        for (index, prediction) in predictions.iter().enumerate() {
            let report = of_plane(
                (&*source, &measurement, index),
                &theories[index],
                prediction,
                args.work.quiet,
            )?;
            draw(&mut results, &scene, &measurement, index, &report)?;
            reports.push(report);
        }
        Ok((results, reports))
    })?;
    if !args.work.quiet {
        deliver(&table::text(&reports))?;
    }
    let mut index = tree_of!({
        "scene": scene.name,
        "scene_hash": scene.hash(),
        "scene_file": scene.file,
        "version": VERSION,
        "seed": scene.run.seed,
        "method": args.photons.method,
        "photons": scene.run.photons,
        "axes": etendue_compare::AXES,
        "planes": reports,
    });
    let finished = results.finish(|files| {
        index["files"] = tree_of!(files);
        json(&index)
    })?;
    say_replaced(&finished, args.work.quiet);
    if !args.work.quiet {
        deliver(&format!("results in {}", finished.folder.display()))?;
    }
    Ok(0)
}

/// Removes the planes that the user has not selected from the scene.
fn choose(scene: &mut Scene, names: &[String]) -> Result<(), Failure> {
    for name in names {
        planes::named(scene, name)?;
    }
    if !names.is_empty() {
        scene.planes.retain(|plane| names.contains(&plane.name));
    }
    Ok(())
}

/// Returns the covariances of a plane. The photons are traced once more for this plane, on a 4D
/// grid.
fn of_plane(
    (source, measurement, index): (&dyn PhotonSource, &Measurement, usize),
    applicability: &Applicability,
    prediction: &Prediction,
    quiet: bool,
) -> Result<CovarianceReport, Failure> {
    let plane = &measurement.planes()[index];
    let options = fitting(plane);
    let passes = if options.keep { 1 } else { 2 };
    let bar = progress::photons(passes * measurement.emitted(), quiet);
    let batches = 0..u32::try_from(measurement.batches().len()).unwrap_or(u32::MAX);
    let field = measure_field(source, index, plane, batches, &options, &|photons| {
        bar.inc(photons);
    });
    bar.finish_and_clear();
    let field = field.map_err(Failure::cannot_run)?;
    let Some(covariance) = &field.covariance else {
        return Err(Failure::cannot_run(
            "a plane has no covariance: this is a bug in etendue",
        ));
    };
    CovarianceReport::new(
        (measurement, index),
        (&field.grid, covariance),
        applicability,
        prediction,
    )
    .map_err(Failure::cannot_run)
}

/// Lowest level of the colors of a spectrum, in decibels below the spectrum's peak.
const FLOOR: f64 = -50.0;

/// Draws the spectrum at azimuth 0 with the ellipses of the spectrum's second moments.
fn draw(
    results: &mut Results,
    scene: &Scene,
    measurement: &Measurement,
    index: usize,
    report: &CovarianceReport,
) -> Result<(), Failure> {
    let plane = &scene.planes[index];
    let power = CrossPower::of_slice(measurement, index, 0).map_err(Failure::cannot_run)?;
    let power = power.power();
    let [x, y] = pictures::spectrum_axes(plane);
    let ellipse = |name: &str, of: fn(&SliceMoment) -> Option<f64>| {
        let [a, b, c] = report.slice.each_ref().map(of);
        let covariance = [a?, b?, c?];
        Some(Ellipse {
            name: format!("{name}, two standard deviations"),
            covariance,
        })
    };
    let all = [
        ellipse("covariance tracing", |m| m.traced),
        ellipse("exact spectrum", |m| m.found.predicted),
        ellipse("photons", |m| m.found.measured),
    ];
    let title = format!("{}: power at azimuth 0", spaced(&plane.name));
    let photons = grouped(measurement.emitted());
    let note = format!(
        "{}, {photons} photons; moments over the frequencies shown",
        scene.name
    );
    let figure = ellipses(&Ellipses {
        title: &title,
        note: &note,
        picture: Picture {
            x,
            y,
            values: power.view(),
        },
        quantity: AxisQuantity::new("|*S*_{0}|^{2}", ""),
        floor: FLOOR,
        ellipses: all,
    })
    .map_err(Failure::cannot_run)?;
    pictures::write(results, &format!("{}/covariance", plane.name), &figure)
}
