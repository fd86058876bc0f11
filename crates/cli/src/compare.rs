//! Implements `etendue compare`: compares a measurement and a prediction that are read from
//! files.

use crate::args::CompareArgs;
use crate::conclude::Ending;
use crate::print::say;
use crate::progress::{self, Terminal};
use crate::threads::on_threads;
use etendue_pipeline::{PredictionSource, read_case};
use etendue_report::{OutputOptions, Stopwatch, plan};
use etendue_store::stored::check_earlier;
use etendue_store::{ArgumentStyle, Failure, Results, SUMMARY};

/// Runs `etendue compare`; returns the exit code.
pub(crate) fn compare(args: &CompareArgs) -> Result<u8, Failure> {
    let mut watch = Stopwatch::start();
    let stage = progress::stage("reading", args.work.quiet);
    let predicted = match (&args.theory, &args.predicted) {
        (Some(file), _) => PredictionSource::File(file),
        (None, Some(folder)) => PredictionSource::Folder(folder),
        (None, None) => unreachable!("one of both arguments is required"),
    };
    let (case, inputs) = read_case(&args.measured, predicted)?;
    stage.finish_and_clear();
    watch.lap("read");
    let plan = plan(
        &case.scene,
        &[],
        inputs,
        args.work.force.force,
        ArgumentStyle::Command,
    );
    check_earlier(
        &args.out.folder,
        SUMMARY,
        &case.scene,
        args.work.force.force,
        ArgumentStyle::Command,
    )?;
    let mut results = Results::claim(&args.out.folder, plan)?;
    let (held, all) = (case.measurement.batches().len(), case.scene.run.batches);
    if !args.work.quiet && held < all as usize {
        say(&format!("{held} of {all} batches were measured"));
    }
    let ending = Ending {
        options: OutputOptions {
            save: &[],
            compact: false,
        },
        expect: args.expect,
        target_error: None,
        quiet: args.work.quiet,
    };
    on_threads(&args.work.threads, || {
        let terminal = Terminal::new(args.work.quiet);
        let judged = ending.judge(&case, &mut results, &terminal)?;
        watch.lap("compare");
        ending.write(&case, judged, results, watch, &terminal)
    })
}
