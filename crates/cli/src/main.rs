//! The `etendue` command: parses, calls the stages, writes what they give.
//!
//! `run` measures a scene, predicts it, compares and draws; `measure`, `predict` and `compare` are its stages
//! over files; `check` says what a scene says.

mod args;
mod bandwidth;
mod batches;
mod check;
mod compare;
mod conclude;
mod converge;
mod drawing;
mod export;
mod failure;
mod field;
mod files;
mod limits;
mod load;
mod machine;
mod measure;
mod method;
mod npz;
mod photons;
mod pictures;
mod predict;
mod predictions;
mod progress;
mod results;
mod run;
mod stored;
mod summary;
mod table;
mod threads;

use args::{Cli, Command};
use clap::Parser;
use std::io::Write;
use std::process::ExitCode;

fn main() -> ExitCode {
    let outcome = match Cli::parse().command {
        Command::Run(args) => run::run(&args),
        Command::Measure(args) => measure::measure(&args),
        Command::Predict(args) => predict::predict(&args),
        Command::Compare(args) => compare::compare(&args),
        Command::Check(args) => check::check(&args),
        Command::Converge(args) => converge::converge(&args),
        Command::Bandwidth(args) => bandwidth::bandwidth(&args),
        Command::Export(args) => export::export(&args),
    };
    match outcome {
        Ok(code) => ExitCode::from(code),
        Err(failure) => {
            // A reader that has gone does not change the exit code.
            let _ = writeln!(std::io::stderr(), "error: {}", failure.message);
            ExitCode::from(failure.code)
        }
    }
}

/// Prints to standard output. A reader that has gone, or a full disk behind it, changes nothing that was
/// done: the result and the exit code stand.
pub(crate) fn say(text: &str) {
    let _ = writeln!(std::io::stdout(), "{text}");
}
