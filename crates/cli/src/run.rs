//! Implements `etendue run`: measures, predicts, compares and draws a scene.

use crate::args::RunArgs;
use crate::conclude::{Ending, code_of};
use crate::print::{deliver_json_file, say};
use crate::progress::Terminal;
use crate::threads::on_threads;
use crate::{report, warnings};
use etendue_compare::Verdict;
use etendue_pipeline::photons::Save;
use etendue_pipeline::{Checkpointing, Leader, Run, Tracing, field};
use etendue_report::page::NAME;
use etendue_report::table::word;
use etendue_report::{OutputOptions, Stopwatch, announcement, check_explorer, plan};
use etendue_scene::{Color, Scene};
use etendue_store::checkpoints::CheckpointStore;
use etendue_store::stored::{check_earlier, summary_of};
use etendue_store::{ArgumentStyle, Failure, Results, SUMMARY, below};
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
    let mut run = args.run()?;
    let folder = args.out.or_named(&run.scene.name);
    on_threads(&args.work.threads, || {
        let terminal = Terminal::new(args.work.quiet);
        check(args, &run, &folder)?;
        let mut results = Some(claim(args, &run, &folder)?);
        if args.resume {
            if let Some(code) = finished(args, &run, &folder) {
                return Ok(code);
            }
            // Several processes share the folder, so no process claims the result until the
            // measurement is complete.
            results = None;
        }
        announce(args, &run.scene);
        let mut watch = Stopwatch::start();
        let Some(traced) = run.trace(tracing(args, workers, &folder), &terminal)? else {
            return finished(args, &run, &folder).ok_or_else(|| gone(&folder));
        };
        watch.lap("trace");
        let (measurement, predictions) = run.predicted(traced, workers, &terminal)?;
        watch.lap("predict");
        let mut results = match results {
            Some(results) => results,
            None => {
                let results = claim(args, &run, &folder)?;
                if let Some(code) = finished(args, &run, &folder) {
                    return Ok(code);
                }
                results
            }
        };
        let case = run.with(measurement, predictions);
        let ending = Ending {
            options: OutputOptions {
                save: &args.save,
                compact: args.compact,
            },
            expect: args.expect,
            target_error: args.target_error,
            quiet: args.is_quiet(),
        };
        let judged = ending.judge(&case, &mut results, &terminal)?;
        watch.lap("compare");
        let code = ending.write(&case, judged, results, watch, &terminal)?;
        CheckpointStore::of(&folder, &case.scene, case.method).remove();
        Ok(code)
    })
}

/// Prints warnings, and fails if the run is too large or its folder has the result of another
/// scene.
fn check(args: &RunArgs, run: &Run, folder: &Path) -> Result<(), Failure> {
    let scene = &run.scene;
    warnings::tell(scene, args.work.quiet);
    run.check_limits()?;
    if args.save.contains(&Save::Field) {
        field::check_memory(scene)?;
    }
    check_explorer(scene, &args.save)?;
    let force = args.work.force.force;
    check_earlier(folder, SUMMARY, scene, force, ArgumentStyle::Command)
}

/// Claims the result folder. With `--resume`, waits until no other process has claimed it.
fn claim(args: &RunArgs, run: &Run, folder: &Path) -> Result<Results, Failure> {
    let plan = plan(
        &run.scene,
        &args.save,
        run.inputs.clone(),
        args.work.force.force,
        ArgumentStyle::Command,
    );
    if args.resume {
        Results::claim_in_turn(folder, plan, &warnings::warn)
    } else {
        Results::claim(folder, plan)
    }
}

/// Announces what `--save` will write.
fn announce(args: &RunArgs, scene: &Scene) {
    if args.is_quiet() {
        return;
    }
    for text in args
        .save
        .iter()
        .filter_map(|save| announcement(scene, *save))
    {
        say(&text);
    }
}

/// How the arguments ask for the photons to be traced.
fn tracing<'a>(args: &RunArgs, workers: Option<&'a Leader<'a>>, folder: &'a Path) -> Tracing<'a> {
    match args.target_error {
        None => Tracing::Stored(Checkpointing {
            folder,
            resume: args.resume,
            until: args.time.and_then(|time| Instant::now().checked_add(time)),
            workers,
        }),
        Some(noise) => Tracing::Until {
            noise,
            most: args.photons.photons,
        },
    }
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

/// Returns the exit code of a run that is already finished, and prints the verdict of this run
/// again. Also removes the batches that a process has left in the folder.
fn finished(args: &RunArgs, run: &Run, folder: &Path) -> Option<u8> {
    let summary = summary_of(folder, &run.scene, run.method)?;
    CheckpointStore::of(folder, &run.scene, run.method).remove();
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

/// The error for a result folder that was removed in the meantime.
fn gone(folder: &Path) -> Failure {
    Failure::cannot_run(format!(
        "the result in {} no longer exists",
        folder.display()
    ))
}
