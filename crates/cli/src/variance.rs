//! Implements `etendue variance`, which predicts the Monte Carlo error of the mean over a window.

use crate::args::{SamplerArg, VarianceArgs};
use crate::finish::finish;
use crate::print::deliver;
use crate::progress::Terminal;
use crate::threads::on_threads;
use etendue_pipeline::variance::{VarianceOptions, VarianceStudy};
use etendue_pipeline::{load, method, point_file, variance_table};
use etendue_report::{pictures, variance};
use etendue_store::{ArgumentStyle, Failure, Plan, Results, VARIANCE};
use etendue_variance::Sampler;
use std::path::PathBuf;

/// The exit code if a prediction is undecided.
const UNDECIDED: u8 = 4;

/// The files beside the index.
const NAMES: [&str; 3] = ["variance.png", "variance.svg", "variance.csv"];

/// Runs `etendue variance`; returns the exit code.
pub(crate) fn variance(args: &VarianceArgs) -> Result<u8, Failure> {
    let scene = load::scene(&args.scene.source(), |run| args.photons.set(run))?;
    method::check(&scene, args.photons.method)?;
    let samplers = samplers(&args.samplers)?;
    let mut inputs = load::inputs(&args.scene.source(), &scene);
    inputs.extend(files(&args.samplers).cloned());
    let plan = Plan {
        index: VARIANCE,
        files: NAMES.map(str::to_owned).to_vec(),
        inputs,
        force: args.work.force.force,
        arguments: ArgumentStyle::Command,
    };
    let folder = args.out.or_named(format!("{}-variance", scene.name));
    let options = VarianceOptions {
        method: args.photons.method,
        frequencies: args.frequencies,
        samplers,
        counts: args.counts.clone(),
        shifts: args.shifts,
        unshifted: args.unshifted,
        arguments: ArgumentStyle::Command,
    };
    let study = VarianceStudy::new(&scene, args.plane.as_deref(), options)?;
    let (mut results, found) = on_threads(&args.work.threads, || {
        study.check_memory()?;
        let results = Results::claim(&folder, plan.clone())?;
        Ok((results, study.run(&Terminal::new(args.work.quiet))?))
    })?;
    if !args.work.quiet {
        deliver(&variance_table::text(&found, study.options()))?;
    }
    let figure = variance::drawn(&scene.name, &found)?;
    pictures::write(&mut results, "variance", &figure)?;
    finish(results, study.index(&scene, &found), args.work.quiet)?;
    Ok(if found.is_undecided() { UNDECIDED } else { 0 })
}

/// Returns the files of points among the samplers.
fn files(samplers: &[SamplerArg]) -> impl Iterator<Item = &PathBuf> {
    samplers.iter().filter_map(|sampler| match sampler {
        SamplerArg::Named(_) => None,
        SamplerArg::File(path) => Some(path),
    })
}

/// Returns the samplers, with the points of files.
fn samplers(named: &[SamplerArg]) -> Result<Vec<Sampler>, Failure> {
    let of = |sampler: &SamplerArg| match sampler {
        SamplerArg::Named(all) => Ok(all.clone()),
        SamplerArg::File(path) => {
            let file = point_file::read(path, ArgumentStyle::Command)?;
            Ok(vec![Sampler::File(file)])
        }
    };
    let all: Vec<Vec<Sampler>> = named.iter().map(of).collect::<Result<_, Failure>>()?;
    Ok(all.concat())
}
