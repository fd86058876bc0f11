//! Implements `etendue variance`, which predicts the Monte Carlo error of the mean over a window.

use crate::args::{VarianceArgs, files, samplers};
use crate::finish::finish;
use crate::print::deliver;
use crate::progress::Terminal;
use crate::threads::on_threads;
use etendue_pipeline::{load, method};
use etendue_report::pictures::PictureFiles;
use etendue_store::{ArgumentStyle, Failure, PROBE, Plan, Results, VARIANCE};
use etendue_studies::variance::{VarianceOptions, VarianceStudy, figure, table};

/// The exit code if a prediction is undecided.
const UNDECIDED: u8 = 4;

/// Runs `etendue variance`; returns the exit code.
pub(crate) fn variance(args: &VarianceArgs) -> Result<u8, Failure> {
    let path = &args.scene.path;
    if path.join(PROBE).is_file() {
        return Err(Failure::bad_input(format!(
            "{}: a saved probe has no rays; allowed: a scene file, or, for errors behind a pixel, `etendue probe SCENE --pixel X,Y --variance=sobol`",
            path.display()
        )));
    }
    let scene = load::scene(&args.scene.source(), |run| args.photons.set(run))?;
    let method = args.photons.method;
    method::check(&scene, method)?;
    let samplers = samplers(&args.samplers)?;
    let mut inputs = load::inputs(&args.scene.source(), &scene);
    inputs.extend(files(&args.samplers).cloned());
    let plan = Plan {
        index: VARIANCE,
        files: figure::NAMES.map(str::to_owned).to_vec(),
        inputs,
        force: args.work.force.force,
        arguments: ArgumentStyle::Command,
    };
    let folder = args.out.or_named(format!("{}-variance", scene.name));
    let options = VarianceOptions {
        frequencies: args.frequencies,
        samplers,
        counts: args.counts.clone(),
        shifts: args.shifts,
        unshifted: args.unshifted,
        light_points: args.light_points,
        arguments: ArgumentStyle::Command,
    };
    let study = VarianceStudy::of_scene(&scene, (args.plane.as_deref(), method), options)?;
    let (mut results, found) = on_threads(&args.work.threads, || {
        study.check_memory()?;
        let results = Results::claim(&folder, plan.clone())?;
        let found = study.run(&Terminal::new(args.work.quiet))?;
        Ok((results, found.ok_or_else(|| study.constant())?))
    })?;
    if !args.work.quiet {
        deliver(&table::text(&found, &study.options))?;
    }
    let figure = figure::drawn(&scene.name, &found)?;
    PictureFiles::new("variance".to_owned(), figure)?.write(&mut results)?;
    finish(
        results,
        study.index((&scene, method), &found),
        args.work.quiet,
    )?;
    Ok(if found.is_undecided() { UNDECIDED } else { 0 })
}
