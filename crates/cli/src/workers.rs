//! Runs commands whose work several processes share.

use crate::args::{Cli, Command, RunArgs};
use crate::exit::{ended, not_parsed};
use crate::threads::on_threads;
use crate::{interrupt, predict, run, sweep};
use etendue_pipeline::{Leader, Silent, Workers, follow_points, follow_run, report_failure};
use etendue_store::Failure;
use etendue_studies::sweep::SweepPoints;
use std::ffi::OsString;

/// Runs a command line on a group of processes; returns the exit code. Only the commands `run`,
/// `predict` and `sweep` share their work.
pub fn command_of_workers(line: impl IntoIterator<Item = OsString>, workers: &dyn Workers) -> u8 {
    let leads = workers.number() == 0;
    let command = match Cli::parse_line(line) {
        Ok(cli) => cli.command,
        Err(error) => {
            // Only the process with the terminal prints the error.
            if leads {
                return not_parsed(&error);
            }
            return u8::try_from(error.exit_code()).unwrap_or(2);
        }
    };
    if !is_shared(&command) {
        let message = "this command cannot use several processes; allowed: predict, sweep, and run without --target-error and --rgb";
        return ended(Err(Failure::bad_input(message)), !leads);
    }
    if !leads {
        follow(&command, workers);
        return 0;
    }
    let led = Leader::new(workers);
    let outcome = interrupt::install().and_then(|()| match &command {
        Command::Run(args) => run::run_with(args, Some(&led)),
        Command::Predict(args) => predict::predict_with(args, Some(&led)),
        Command::Sweep(args) => sweep::sweep_with(args, Some(&led)),
        _ => Ok(0),
    });
    // The other processes are idle at this point, because no work is left or because a step
    // failed.
    let dismissed = led.dismiss_all();
    ended(outcome.and_then(|code| dismissed.map(|()| code)), false)
}

fn is_shared(command: &Command) -> bool {
    match command {
        Command::Run(RunArgs {
            target_error, rgb, ..
        }) => target_error.is_none() && !rgb,
        command => matches!(command, Command::Predict(_) | Command::Sweep(_)),
    }
}

/// Carries out the orders of the leading process until this process is dismissed.
fn follow(command: &Command, workers: &dyn Workers) {
    let followed = match command {
        Command::Run(args) => on_threads(&args.work.threads, || follow_run(workers, &args.run()?)),
        Command::Predict(args) => on_threads(&args.work.threads, || {
            follow_run(workers, &args.photons.run(&args.scene)?)
        }),
        Command::Sweep(args) => on_threads(&args.work.threads, || {
            let points = SweepPoints::read(&args.request())?;
            follow_points(workers, points.scenes(), &|number| {
                points.run(number, &Silent)
            })
        }),
        _ => Ok(()),
    };
    if let Err(failure) = followed {
        report_failure(workers, failure);
    }
}
