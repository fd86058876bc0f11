//! Implements `etendue run`: measures, predicts, compares and draws a scene.

use crate::args::RunArgs;
use crate::conclude::{Ending, code_of, conclude};
use crate::print::{deliver_json_file, say};
use crate::progress::Terminal;
use crate::report;
use crate::threads::on_threads;
use crate::warnings;
use etendue_compare::Verdict;
use etendue_pipeline::checkpoint::{self, Checkpointing};
use etendue_pipeline::photons::Save;
use etendue_pipeline::table::word;
use etendue_pipeline::{Job, Leader, Stopwatch};
use etendue_pipeline::{field, photons, target};
use etendue_report::page::NAME;
use etendue_report::{OutputOptions, plan};
use etendue_scene::{Color, Scene};
use etendue_store::Failure;
use etendue_store::checkpoints::CheckpointStore;
use etendue_store::stored::{check_earlier, summary_of};
use etendue_store::{ArgumentStyle, Plan, Results, SUMMARY, below};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Runs `etendue run`; returns the exit code.
pub(crate) fn run(args: &RunArgs) -> Result<u8, Failure> {
    if args.rgb {
        channels(args)
    } else {
        run_with(args, None)
    }
}

/// Runs a scene once for each channel; returns the exit code of the worst verdict. The runs have
/// the same seed, so they trace the same photons with different weights.
fn channels(args: &RunArgs) -> Result<u8, Failure> {
    let name = args.scene.path.file_stem().unwrap_or_default();
    let folder = args.out.or_named(name);
    let colors = [Color::Red, Color::Green, Color::Blue];
    let folders = colors.iter().map(|color| below(&folder, color.name()));
    let folders: Vec<PathBuf> = folders.collect::<Result<_, _>>()?;
    let page = folder.join(NAME);
    if page.exists() {
        // A page that cannot be replaced is refused before the runs.
        report::claim(&folders, &page, args.work.force.force)?;
    }
    let mut codes = Vec::new();
    for (color, folder) in colors.into_iter().zip(&folders) {
        let mut one = args.clone();
        one.scene.color = Some(color);
        one.out.folder = Some(folder.clone());
        codes.push(run_with(&one, None)?);
    }
    report::write(&folders, &page, args.work.force.force)?;
    if !args.work.quiet {
        say(&format!("all channels in {}", page.display()));
    }
    // A disagreement is worse than an undecided plane.
    let worst = codes.iter().max().copied().unwrap_or_default();
    Ok(if codes.contains(&1) { 1 } else { worst })
}

/// Runs [`run()`], and shares the measurement with other processes.
pub(crate) fn run_with(args: &RunArgs, workers: Option<&Leader<'_>>) -> Result<u8, Failure> {
    let code = run_scene(args, workers)?;
    if args.json {
        let name = args.scene.path.file_stem().unwrap_or_default();
        deliver_json_file(&args.out.or_named(name).join(SUMMARY))?;
    }
    Ok(code)
}

fn run_scene(args: &RunArgs, workers: Option<&Leader<'_>>) -> Result<u8, Failure> {
    check_saved(&args.save)?;
    let job = args.photons.job(&args.scene)?;
    let folder = args.out.or_named(&job.scene.name);
    let plan = plan(
        &job.scene,
        &args.save,
        job.inputs.clone(),
        args.work.force.force,
        ArgumentStyle::Command,
    );
    on_threads(&args.work.threads, || {
        let scene = &job.scene;
        warnings::tell(scene, args.work.quiet);
        job.check_limits()?;
        if args.save.contains(&Save::Field) {
            field::check_memory(scene)?;
        }
        check_earlier(
            &folder,
            SUMMARY,
            scene,
            args.work.force.force,
            ArgumentStyle::Command,
        )?;
        let begin = |plan: Plan| {
            if args.resume {
                Results::claim_in_turn(&folder, plan, &warnings::warn)
            } else {
                Results::claim(&folder, plan)
            }
        };
        let mut results = Some(begin(plan.clone())?);
        if args.resume {
            if let Some(code) = finished(&folder, scene, args) {
                return Ok(code);
            }
            // Several processes share the folder, so no process claims the result until the
            // measurement is complete.
            results = None;
        }
        let place = ResultPlace {
            folder: &folder,
            plan,
            results,
            workers,
        };
        stages(args, job, place)
    })
}

/// Fails if `--save` names the same data twice.
fn check_saved(save: &[Save]) -> Result<(), Failure> {
    let mut each = save.iter().enumerate();
    let Some((_, twice)) = each.find(|(i, what)| save[..*i].contains(what)) else {
        return Ok(());
    };
    let name = twice.name();
    Err(Failure::bad_input(format!("--save: {name} is given twice")))
}

/// The folder to which a result will be written, and the processes that share the work.
struct ResultPlace<'a> {
    folder: &'a Path,
    plan: Plan,
    /// The claimed result folder; `None` if several processes measure.
    results: Option<Results>,
    /// The leader of the other processes, if several processes share the measurement.
    workers: Option<&'a Leader<'a>>,
}

/// Returns the exit code of a run that is already finished, and prints the verdict of this run
/// again. Also removes the batches that a process has left in the folder.
fn finished(folder: &Path, scene: &Scene, args: &RunArgs) -> Option<u8> {
    let summary = summary_of(folder, scene, args.photons.method)?;
    CheckpointStore::of(folder, scene, args.photons.method).remove();
    let verdict: Verdict = serde_json::from_value(summary["verdict"].clone()).ok()?;
    if !args.is_quiet() {
        say(&format!(
            "verdict: {}; the run was already finished: {}",
            word(verdict),
            folder.display()
        ));
    }
    Some(code_of(verdict))
}

/// Returns the error for a result folder that was removed in the meantime.
fn gone(folder: &Path) -> Failure {
    Failure::cannot_run(format!(
        "the result in {} no longer exists",
        folder.display()
    ))
}

fn stages(args: &RunArgs, mut job: Job, place: ResultPlace<'_>) -> Result<u8, Failure> {
    let mut watch = Stopwatch::start();
    if !args.is_quiet() {
        let kept = args.save.iter();
        for announcement in kept.filter_map(|save| photons::announcement(&job.scene, *save)) {
            say(&announcement);
        }
    }
    let terminal = Terminal::new(args.work.quiet);
    let method = job.method;
    let kept = CheckpointStore::of(place.folder, &job.scene, method);
    let checkpointing = Checkpointing {
        resume: args.resume,
        until: args.time.and_then(|time| Instant::now().checked_add(time)),
        workers: place.workers,
    };
    let measurement = match args.target_error {
        None => {
            let is_done = || summary_of(place.folder, &job.scene, method).is_some();
            checkpoint::measured(
                &job.scene,
                method,
                (&kept, &is_done),
                checkpointing,
                &terminal,
            )?
        }
        Some(target) => {
            let target = (target, args.photons.photons);
            Some(target::reached(&mut job.scene, method, target, &terminal)?)
        }
    };
    let Some(measurement) = measurement else {
        return finished(place.folder, &job.scene, args).ok_or_else(|| gone(place.folder));
    };
    watch.lap("trace");
    let predictions = job.predictions(place.workers, &terminal)?;
    watch.lap("predict");
    let case = job.with(measurement, predictions);
    let results = match place.results {
        Some(results) => results,
        None => {
            let results = Results::claim_in_turn(place.folder, place.plan, &warnings::warn)?;
            if let Some(code) = finished(place.folder, &case.scene, args) {
                return Ok(code);
            }
            results
        }
    };
    let ending = Ending {
        options: OutputOptions {
            save: &args.save,
            compact: args.compact,
        },
        expect: args.expect,
        target_error: args.target_error,
        quiet: args.is_quiet(),
    };
    let code = conclude(&case, &ending, results, watch)?;
    kept.remove();
    Ok(code)
}
