//! Implements `etendue sweep`, which runs a scene for several values of its fields.

use crate::args::SweepArgs;
use crate::conclude::code_of;
use crate::print::say;
use crate::progress::Terminal;
use crate::threads::on_threads;
use crate::warnings;
use etendue_compare::Verdict;
use etendue_pipeline::Leader;
use etendue_report::table::aligned;
use etendue_store::Failure;
use etendue_studies::derivative::derivative;
use etendue_studies::sweep::{FinishedSweep, SweepPoints, run};

/// The maximum number of undecided planes whose reasons are printed.
const MAX_REASONS: usize = 4;

/// Runs `etendue sweep`; returns the exit code.
pub(crate) fn sweep(args: &SweepArgs) -> Result<u8, Failure> {
    sweep_with(args, None)
}

/// Runs [`sweep()`], and shares the points of the sweep with other processes.
pub(crate) fn sweep_with(args: &SweepArgs, workers: Option<&Leader<'_>>) -> Result<u8, Failure> {
    on_threads(&args.work.threads, || {
        let mut request = args.request();
        let field = match &args.derivative {
            Some(field) => Some((field, field.sweep(&mut request)?)),
            None => None,
        };
        let all = SweepPoints::read(&request)?;
        let kind = if field.is_some() {
            "derivative"
        } else {
            "sweep"
        };
        let folder = args.out.or_named(format!("{}-{kind}", all.name()));
        if !args.work.quiet {
            for warning in all.warnings() {
                warnings::warn(&warning);
            }
        }
        let terminal = Terminal::new(args.work.quiet);
        if let Some((field, value)) = field {
            let parts = (&request, &all, &*folder);
            let derivative = derivative(field, value, parts, workers, &terminal)?;
            if !args.work.quiet {
                say(&derivative.text());
                print_end(&derivative.sweep);
            }
            return Ok(code_of(derivative.verdict));
        }
        let finished = run(&request, &all, &folder, workers, &terminal)?;
        if !args.work.quiet {
            print(&finished);
        }
        let [_, fail, undecided] = finished.verdicts;
        Ok(code_of(match (fail > 0, undecided > 0) {
            (true, _) => Verdict::Fail,
            (false, true) => Verdict::Undecided,
            (false, false) => Verdict::Pass,
        }))
    })
}

fn print(finished: &FinishedSweep) {
    say(&aligned(finished.rows.clone()).join("\n"));
    if !finished.has_curves {
        say("no curves are drawn, because the figure would have more than 24 panels");
    }
    print_end(finished);
}

/// Prints the verdicts of the points and the folder.
fn print_end(finished: &FinishedSweep) {
    let FinishedSweep {
        folder,
        verdicts: [pass, fail, undecided],
        undecided: reasons,
        ..
    } = finished;
    let all = pass + fail + undecided;
    say(&format!(
        "{all} points: {pass} pass, {fail} fail, {undecided} undecided"
    ));
    for reason in reasons.iter().take(MAX_REASONS) {
        say(&format!("  undecided: {reason}"));
    }
    let more = reasons.len().saturating_sub(MAX_REASONS);
    if more > 0 {
        say(&format!("  and {more} more planes"));
    }
    say(&format!("sweep in {}", folder.display()));
}
