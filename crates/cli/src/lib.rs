//! The `etendue` command: parses arguments, calls the stages and writes their results.
//!
//! `run` measures a scene, predicts its spectra, compares and draws. `measure`, `predict` and
//! `compare` are the stages of `run`, and exchange files. `check` describes a scene.
//!
//! This crate computes nothing: `etendue_pipeline` runs the stages, and `etendue_report` draws
//! results.

mod args;
mod bandwidth;
mod check;
mod compare;
mod conclude;
mod converge;
mod covariance;
mod diff;
mod exit;
mod export;
mod figure;
mod finish;
mod fit;
mod interrupt;
mod manual;
mod measure;
mod new;
mod predict;
mod print;
mod progress;
mod rays;
mod report;
mod run;
mod schema;
mod spectrum;
mod split;
mod sweep;
mod threads;
mod variance;
mod warnings;
mod workers;
#[cfg(feature = "worlds")]
mod worlds;

use args::{Cli, Command};
use etendue_store::COMMIT;
use exit::{ended, not_parsed};
use std::ffi::OsString;
use std::process::ExitCode;
pub use workers::command_of_workers;

/// Runs the program; returns its exit code.
#[must_use]
pub fn main() -> ExitCode {
    ExitCode::from(command(std::env::args_os()))
}

/// Runs a command line whose first word is the name of the program; returns the exit code.
///
/// The signal handlers of the command stay installed after the function returns.
pub fn command(line: impl IntoIterator<Item = impl Into<OsString> + Clone>) -> u8 {
    COMMIT.get_or_init(|| env!("ETENDUE_COMMIT"));
    let command = match Cli::parse_line(line) {
        Ok(cli) => cli.command,
        Err(error) => return not_parsed(&error),
    };
    let outcome = interrupt::install().and_then(|()| match command {
        Command::New(args) => new::new(&args),
        Command::Run(args) => run::run(&args),
        Command::Measure(args) => measure::measure(&args),
        Command::Split(args) => split::split(&args),
        Command::Predict(args) => predict::predict(&args),
        Command::Compare(args) => compare::compare(&args),
        Command::Check(args) => check::check(&args),
        Command::Converge(args) => converge::converge(&args),
        Command::Figure(args) => figure::figure(&args),
        Command::Diff(args) => diff::diff(&args),
        Command::Report(args) => report::report(&args),
        Command::Sweep(args) => sweep::sweep(&args),
        Command::Fit(args) => fit::fit(&args),
        Command::Bandwidth(args) => bandwidth::bandwidth(&args),
        Command::Covariance(args) => covariance::covariance(&args),
        Command::Variance(args) => variance::variance(&args),
        Command::Export(args) => export::export(&args),
        #[cfg(feature = "worlds")]
        Command::World(command) => worlds::run(&command),
        Command::Rays(args) => rays::rays(&args),
        Command::Spectrum(args) => spectrum::spectrum(&args),
        Command::Schema(args) => schema::schema(&args),
        Command::Completions(args) => manual::completions(&args),
        Command::Man(args) => manual::man(&args),
    });
    ended(outcome, false)
}
