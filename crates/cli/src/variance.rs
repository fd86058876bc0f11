//! Implements `etendue variance`, which predicts the Monte Carlo error of the mean over a window.

mod picture;
mod plane_variance;
mod points;
mod table;

use crate::args::{SamplerArg, VarianceArgs};
use crate::print::{deliver, say_replaced};
use crate::progress::Terminal;
use crate::threads::on_threads;
use etendue_field::PhotonSource;
use etendue_pipeline::{Reporter, Work, load, method};
use etendue_report::pictures;
use etendue_scene::Scene;
use etendue_store::sealed::json;
use etendue_store::{ArgumentStyle, Failure, Plan, Results, VARIANCE, VERSION, machine};
use etendue_variance::{
    AXES, MeasuredPower, PowerEstimate, Sampler, VarianceError, WindowRadiance, WindowStudy,
    axis_sets, dyadic_power, field_options, with_box_window,
};
use plane_variance::PlaneVariance;
use serde_json::json as tree_of;
use std::path::PathBuf;

/// The exit code if a prediction is undecided.
const UNDECIDED: u8 = 4;

/// The files beside the index.
const NAMES: [&str; 3] = ["variance.png", "variance.svg", "variance.csv"];

/// Runs `etendue variance`; returns the exit code.
pub(crate) fn variance(args: &VarianceArgs) -> Result<u8, Failure> {
    let scene = load::scene(&args.scene.source(), |run| args.photons.set(run))?;
    let index = chosen(&scene, args.plane.as_deref())?;
    method::check(&scene, args.photons.method)?;
    let samplers = samplers(&args.samplers)?;
    let counts = &args.counts.0;
    if samplers.iter().all(|s| s.counts(counts).is_empty()) {
        let shown: Vec<String> = counts.iter().map(usize::to_string).collect();
        return Err(Failure::bad_input(format!(
            "--counts {}: no sampler has sets of so many points; allowed: n^4 for jitter, 2^k for sobol, n^2 for padded, any number for independent and lhs",
            shown.join(",")
        )));
    }
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
    let boxed = with_box_window(&scene, index, args.frequencies);
    let radiance = WindowRadiance::new(&boxed).map_err(failure)?;
    let (mut results, found) = on_threads(&args.work.threads, || {
        check_memory(&boxed, args.frequencies)?;
        let results = Results::claim(&folder, plan.clone())?;
        let terminal = Terminal::new(args.work.quiet);
        Ok((
            results,
            studied(args, &boxed, &radiance, &samplers, &terminal)?,
        ))
    })?;
    if !args.work.quiet {
        deliver(&table::text(&found, args))?;
    }
    let figure = picture::drawn(&scene.name, &found)?;
    pictures::write(&mut results, "variance", &figure)?;
    let mut index = index_of(&scene, args, &found);
    let finished = results.finish(|files| {
        index["files"] = tree_of!(files);
        json(&index)
    })?;
    say_replaced(&finished, args.work.quiet);
    if !args.work.quiet {
        deliver(&format!("results in {}", finished.folder.display()))?;
    }
    let curves = found.samplers.iter().map(|sampler| &sampler.shifted);
    let is_undecided = curves
        .flat_map(|curve| &curve.counts)
        .any(|count| count.is_undecided);
    Ok(if is_undecided { UNDECIDED } else { 0 })
}

/// Returns the index of the selected plane.
fn chosen(scene: &Scene, name: Option<&str>) -> Result<usize, Failure> {
    let all: Vec<&str> = scene.planes.iter().map(|p| p.name.as_str()).collect();
    let allowed = all.join(", ");
    match name {
        Some(name) => {
            let index = all.iter().position(|plane| *plane == name);
            index.ok_or_else(|| {
                Failure::bad_input(format!(
                    "--plane {name}: the scene has no such plane; allowed: {allowed}"
                ))
            })
        }
        None if all.len() == 1 => Ok(0),
        None => Err(Failure::bad_input(format!(
            "the scene has several planes: select one with --plane; allowed: {allowed}"
        ))),
    }
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
        SamplerArg::File(path) => Ok(vec![Sampler::File(points::read(path)?)]),
    };
    let all: Vec<Vec<Sampler>> = named.iter().map(of).collect::<Result<_, Failure>>()?;
    Ok(all.concat())
}

/// Fails if the grids of all groups of photons do not fit into memory.
fn check_memory(scene: &Scene, max: usize) -> Result<(), Failure> {
    let memory = machine::available_memory();
    let options = field_options();
    let grid = options.grid(&scene.planes[0]);
    // Grids of groups are kept, and then their spectra are.
    let bytes = options.bytes(&grid, rayon::current_num_threads());
    if bytes > memory {
        let [nx, ny, nu, nv] = grid.cells;
        let [needed, memory] = [bytes, memory].map(|bytes| bytes as f64 / 1e9);
        return Err(Failure::cannot_run(format!(
            "--frequencies {max}: the grid has {nx} x {ny} x {nu} x {nv} cells and needs {needed:.1} GB; {memory:.1} GB are available"
        )));
    }
    Ok(())
}

/// Predicts and finds the variances at the only plane of a scene.
fn studied(
    args: &VarianceArgs,
    scene: &Scene,
    radiance: &WindowRadiance,
    samplers: &[Sampler],
    reporter: &dyn Reporter,
) -> Result<PlaneVariance, Failure> {
    let source = method::source(scene, args.photons.method)?;
    let bar = reporter.begin(Work::Photons(scene.run.photons));
    let power = MeasuredPower::measure(scene, &*source, args.frequencies, &|photons| {
        bar.advance(photons);
    });
    drop(bar);
    let power = power.map_err(failure)?;
    let bands = bands(args, scene, &*source, reporter)?;
    let counts = &args.counts.0;
    let curves = |sampler: &Sampler| match sampler {
        Sampler::Independent | Sampler::File(_) => 1,
        _ => 1 + usize::from(args.unshifted),
    };
    let sets = samplers.iter().map(|s| s.counts(counts).len() * curves(s));
    let sets = sets.sum::<usize>() * args.shifts as usize;
    let steps = WindowRadiance::steps();
    let bar = reporter.begin(Work::Steps {
        verb: "tracing back",
        total: sets + usize::try_from(steps).unwrap_or_default(),
        things: "sets of rays",
    });
    let progress = |sets: u64| bar.advance(sets);
    let moments = radiance.moments(scene.run.seed, &progress);
    if moments.variance.value <= 0.0 {
        return Err(Failure::bad_input(format!(
            "{}: the radiance is the same over the whole window, so its mean has no error",
            scene.planes[0].name
        )));
    }
    let study = WindowStudy {
        power: &power,
        bands: bands.as_ref(),
        radiance,
        moments: &moments,
        sets: args.shifts,
        seed: scene.run.seed,
    };
    let each = samplers.iter();
    let reports = each.map(|sampler| study.sampler(sampler, counts, &progress));
    let plane = &scene.planes[0];
    let window = plane.window;
    Ok(PlaneVariance {
        plane: plane.name.clone(),
        half_widths: [window.x, window.u, window.y, window.v].map(|p| p.half_width()),
        mean_by_photons: power.mean,
        inside: power.spectrum.total() / moments.variance.value,
        axis_sets: axis_sets(&power, &moments),
        samplers: reports.collect(),
        moments,
    })
}

/// Traces the photons once more, and returns their power in dyadic bands, if it is requested.
fn bands(
    args: &VarianceArgs,
    scene: &Scene,
    source: &dyn PhotonSource,
    reporter: &dyn Reporter,
) -> Result<Option<PowerEstimate>, Failure> {
    if !args.unshifted {
        return Ok(None);
    }
    let bar = reporter.begin(Work::Photons(scene.run.photons));
    let bands = dyadic_power(scene, source, &|photons| bar.advance(photons));
    bands.map(Some).map_err(failure)
}

/// Returns the content of the index, without its list of files.
fn index_of(scene: &Scene, args: &VarianceArgs, found: &PlaneVariance) -> serde_json::Value {
    tree_of!({
        "scene": scene.name,
        "scene_hash": scene.hash(),
        "scene_file": scene.file,
        "version": VERSION,
        "seed": scene.run.seed,
        "method": args.photons.method,
        "photons": scene.run.photons,
        "plane": found.plane,
        "window": { "profile": "Box", "half_widths": found.half_widths },
        "axes": AXES,
        "frequencies": args.frequencies,
        "shifts": args.shifts,
        "mean_by_photons": found.mean_by_photons,
        "mean_by_rays": found.moments.mean,
        "variance": found.moments.variance,
        "noise": found.moments.noise,
        "inside": found.inside,
        "axis_sets": found.axis_sets,
        "samplers": found.samplers,
    })
}

/// Returns the failure for a plane that cannot be studied.
fn failure(error: VarianceError) -> Failure {
    match error {
        VarianceError::TooFewBatches(_) => Failure::bad_input(format!("run.batches: {error}")),
        _ => Failure::bad_input(error),
    }
}
