//! Ends commands that compare a measurement with predictions: judges the planes, writes the result,
//! prints it and determines the exit code.

use crate::args::Expect;
use crate::print::{say, say_replaced};
use crate::progress::Terminal;
use etendue_compare::{PlaneReport, Verdict};
use etendue_field::{percent, tidy};
use etendue_pipeline::photons::Save;
use etendue_pipeline::{Judged, MeasuredScene, Reporter, Summary, Work};
use etendue_report::{OutputOptions, Stopwatch, table, write_result};
use etendue_store::{Failure, Finished, Results};
use indicatif::HumanDuration;
use std::time::Duration;

/// The user's options for the conclusion of a command.
#[derive(Debug)]
pub(crate) struct Ending<'a> {
    pub(crate) options: OutputOptions<'a>,
    pub(crate) expect: Option<Expect>,
    /// The maximum noise that the user allows.
    pub(crate) target_error: Option<f64>,
    pub(crate) quiet: bool,
}

impl Ending<'_> {
    /// Compares the measurement with the predictions.
    pub(crate) fn judge(
        &self,
        case: &MeasuredScene,
        results: &mut Results,
        terminal: &Terminal,
    ) -> Result<Judged, Failure> {
        let has_fields = self.options.save.contains(&Save::Field);
        Judged::of(case, has_fields.then_some(results), terminal)
    }

    /// Draws, writes and prints the result; returns the exit code.
    pub(crate) fn write(
        &self,
        case: &MeasuredScene,
        judged: Judged,
        results: Results,
        watch: Stopwatch,
        terminal: &Terminal,
    ) -> Result<u8, Failure> {
        let seconds = watch.seconds("trace");
        let stage = terminal.begin(Work::Stage("writing results"));
        let finished = write_result(case, &self.options, results, &judged, watch)?;
        drop(stage);
        say_replaced(&finished, self.quiet);
        if !self.quiet {
            self.print(&judged.summary, finished, seconds);
        }
        Ok(exit_code(self.expect, &judged.summary))
    }

    /// Prints the table, and what a longer run would achieve; `seconds` is the duration of tracing.
    fn print(&self, summary: &Summary, finished: Finished, seconds: Option<f64>) {
        say(&table::text(summary));
        say(&format!("results in {}", finished.folder.display()));
        if let Some(target) = self.target_error {
            say(&left_out(&summary.planes, target));
        }
        if let Some(outlook) = seconds.and_then(|s| outlook(&summary.planes, s)) {
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
}

/// Describes the noise of the run, and predicts the noise of a run that lasts a hundred times as
/// long. Returns `None` if there is no light.
fn outlook(planes: &[PlaneReport], seconds: f64) -> Option<String> {
    let (plane, noise) = noisiest(planes.iter())?;
    let longer = HumanDuration(Duration::try_from_secs_f64(100.0 * seconds).ok()?);
    let [noise, less] = [noise, 0.1 * noise].map(|noise| percent(noise, 3));
    Some(format!(
        "noise is {noise} at {plane}; a run with 100 times as many photons takes about {longer}, \
         and has noise of {less} or less"
    ))
}

/// The plane with the largest noise, and this noise, if any plane has light.
fn noisiest<'a>(planes: impl Iterator<Item = &'a PlaneReport>) -> Option<(&'a String, f64)> {
    let noise = planes.filter_map(|plane| Some((&plane.name, plane.noise_limit?)));
    noise.max_by(|(_, a), (_, b)| a.total_cmp(b))
}

/// Describes the noise of predictions, which `target` does not include.
fn left_out(planes: &[PlaneReport], target: f64) -> String {
    let sampled = planes
        .iter()
        .filter(|plane| plane.quadrature_error.is_some_and(|error| error > 0.0));
    let rest = match noisiest(sampled) {
        Some((name, noise)) => format!(
            "if the errors of predictions are included, the largest noise is {} (at {name})",
            percent(noise, 3)
        ),
        None => "all predictions are in closed form".to_owned(),
    };
    format!(
        "--target-error {} %: the noise of the photons at each plane is at most this share; {rest}",
        tidy(100.0 * target)
    )
}

/// The exit code under `--expect`: photons must agree with every exact prediction, and
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

/// The exit code for a verdict.
pub(crate) fn code_of(verdict: Verdict) -> u8 {
    match verdict {
        Verdict::Pass => 0,
        Verdict::Fail => 1,
        Verdict::Undecided => 4,
    }
}
