//! Implements `etendue covariance`, which shows covariance tracing beside the measured spectra of
//! a scene.

mod table;

use crate::args::CovarianceArgs;
use crate::finish::finish;
use crate::print::deliver;
use crate::progress::Terminal;
use crate::threads::on_threads;
use etendue_pipeline::covariance::CovarianceStudy;
use etendue_pipeline::{Run, load, planes};
use etendue_report::covariance::drawn;
use etendue_report::pictures::PictureFiles;
use etendue_scene::Scene;
use etendue_store::{ArgumentStyle, COVARIANCE, Failure, Plan, Results};

/// The files written for each plane: a picture in two formats, and the data of this picture.
const NAMES: [&str; 3] = ["covariance.png", "covariance.svg", "covariance.csv"];

/// Runs `etendue covariance`; returns the exit code.
pub(crate) fn covariance(args: &CovarianceArgs) -> Result<u8, Failure> {
    let mut scene = load::scene(&args.scene.source(), |run| args.photons.set(run))?;
    choose(&mut scene, &args.plane)?;
    let inputs = load::inputs(&args.scene.source(), &scene);
    let run = Run::of(scene, args.photons.method, inputs.clone())?;
    let study = CovarianceStudy::new(run)?;
    let scene = study.scene();
    let folder = args.out.or_named(format!("{}-covariance", scene.name));
    let planes = scene.planes.iter();
    let files = planes.flat_map(|plane| NAMES.map(|file| format!("{}/{file}", plane.name)));
    let plan = Plan {
        index: COVARIANCE,
        files: files.collect(),
        inputs,
        force: args.work.force.force,
        arguments: ArgumentStyle::Command,
    };
    let (mut results, found) = on_threads(&args.work.threads, || {
        study.check_limits()?;
        let results = Results::claim(&folder, plan.clone())?;
        Ok((results, study.run(&Terminal::new(args.work.quiet))?))
    })?;
    for (index, plane) in scene.planes.iter().enumerate() {
        let figure = drawn(scene, &found, index)?;
        PictureFiles::new(format!("{}/covariance", plane.name), figure)?.write(&mut results)?;
    }
    if !args.work.quiet {
        deliver(&table::text(&found.reports))?;
    }
    finish(results, study.index(&found), args.work.quiet)?;
    Ok(0)
}

/// Removes the planes that the user has not selected from the scene.
fn choose(scene: &mut Scene, names: &[String]) -> Result<(), Failure> {
    for name in names {
        planes::named(scene, name, ArgumentStyle::Command)?;
    }
    if !names.is_empty() {
        scene.planes.retain(|plane| names.contains(&plane.name));
    }
    Ok(())
}
