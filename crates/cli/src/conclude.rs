//! Ends commands that compare a measurement with predictions: writes the result, prints it and
//! determines the exit code.

use crate::args::Expect;
use crate::print::{say, say_replaced};
use crate::progress::Terminal;

use etendue_compare::{PlaneReport, Verdict};
use etendue_pipeline::photons::Save;
use etendue_pipeline::{Judged, MeasuredScene, Reporter, Stopwatch, Summary, Work, table, target};
use etendue_report::{OutputOptions, write_result};
use etendue_store::{Failure, Results};

/// The user's options for the conclusion of a command.
#[derive(Debug)]
pub(crate) struct Ending<'a> {
    pub(crate) options: OutputOptions<'a>,
    pub(crate) expect: Option<Expect>,
    /// The maximum noise that the user allows.
    pub(crate) target_error: Option<f64>,
    pub(crate) quiet: bool,
}

/// Compares, draws and writes the result; returns the exit code.
pub(crate) fn conclude(
    case: &MeasuredScene,
    ending: &Ending<'_>,
    mut results: Results,
    mut watch: Stopwatch,
) -> Result<u8, Failure> {
    let fields = ending.options.save.contains(&Save::Field);
    let terminal = Terminal::new(ending.quiet);
    let judged = Judged::of(case, fields.then_some(&mut results), &terminal)?;
    watch.lap("compare");
    let stage = terminal.begin(Work::Stage("writing results"));
    let seconds = watch.seconds("trace");
    let finished = write_result(case, &ending.options, results, &judged, watch)?;
    drop(stage);
    say_replaced(&finished, ending.quiet);
    let summary = judged.summary;
    if !ending.quiet {
        say(&table::text(&summary));
        say(&format!("results in {}", finished.folder.display()));
        let left_out = ending.target_error;
        if let Some(left_out) = left_out.map(|t| target::left_out(&summary.planes, t)) {
            say(&left_out);
        }
        if let Some(outlook) = seconds.and_then(|s| target::outlook(&summary.planes, s)) {
            say(&outlook);
        }
        let mut gone = finished.gone;
        gone.retain(|name| name.ends_with(".npy"));
        if !gone.is_empty() {
            let names = gone.join(", ");
            say(&format!(
                "this run removed files of the earlier result, and did not save them again: {names}"
            ));
        }
    }
    Ok(exit_code(ending.expect, &summary))
}

/// Returns the exit code under `--expect`: photons must agree with every exact prediction, and
/// must show that the map of a first-order chain is wrong.
fn exit_code(expect: Option<Expect>, summary: &Summary) -> u8 {
    let is_wrong = |plane: &PlaneReport| {
        let chain = plane.first_order.as_ref();
        chain.is_some_and(|chain| chain.verdict == Verdict::Fail)
    };
    let verdict = match expect {
        None => summary.verdict,
        Some(Expect::Disagreement) => {
            let exact = summary.planes.iter().map(PlaneReport::exact_verdict);
            match exact.fold(Verdict::Pass, Verdict::and) {
                Verdict::Pass if !summary.planes.iter().any(is_wrong) => Verdict::Fail,
                verdict => verdict,
            }
        }
    };
    code_of(verdict)
}

/// Returns the exit code for a verdict.
pub(crate) fn code_of(verdict: Verdict) -> u8 {
    match verdict {
        Verdict::Pass => 0,
        Verdict::Fail => 1,
        Verdict::Undecided => 4,
    }
}
