//! The `etendue` command: parses, calls the stages, writes what they give.
//!
//! `run` measures a scene, predicts it, compares and draws; `measure`, `predict` and `compare` are its stages
//! over files; `check` says what a scene says.

mod args;
mod bandwidth;
mod check;
mod compare;
mod conclude;
mod converge;
mod covariance;
mod diff;
mod export;
mod figure;
mod interrupt;
mod measure;
mod predict;
mod probe;
mod progress;
mod rays;
mod render;
mod report;
mod run;
mod schema;
mod split;
mod sweep;
mod threads;
mod values;
mod warnings;
mod workers;
mod world;

use args::{Cli, Command};
use clap::Parser;
use etendue_scene::shown;
use etendue_store::Failure;
use etendue_store::Finished;
use std::ffi::OsString;
use std::io::{ErrorKind, Write};
use std::path::Path;
use std::process::ExitCode;
pub use workers::command_of_workers;

/// The program: its exit code.
#[must_use]
pub fn main() -> ExitCode {
    ExitCode::from(command(std::env::args_os()))
}

/// Does what a command line says, whose first word is the program; returns the exit code.
///
/// Signals are those of the command from then on.
pub fn command(line: impl IntoIterator<Item = impl Into<OsString> + Clone>) -> u8 {
    let command = match Cli::try_parse_from(line) {
        Ok(cli) => cli.command,
        Err(error) => return not_parsed(&error),
    };
    let outcome = interrupt::install().and_then(|()| match command {
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
        Command::Bandwidth(args) => bandwidth::bandwidth(&args),
        Command::Covariance(args) => covariance::covariance(&args),
        Command::Export(args) => export::export(&args),
        Command::Import(args) => world::report(&args),
        Command::Render(args) => render::render(&args),
        Command::Probe(args) => probe::probe(&args),
        Command::Rays(args) => rays::rays(&args),
        Command::Schema(args) => schema::schema(&args),
    });
    ended(outcome, false)
}

/// Prints the fault of a command line, or the help or the version that it asks for; returns the exit code.
fn not_parsed(error: &clap::Error) -> u8 {
    match error.print() {
        Err(e) if !error.use_stderr() && e.kind() != ErrorKind::BrokenPipe => ended(
            Err(Failure::write(Path::new("to standard output"), e)),
            false,
        ),
        _ => u8::try_from(error.exit_code()).unwrap_or(2),
    }
}

/// The exit code of what a command came to; a failure is told, unless somebody else tells it.
fn ended(outcome: Result<u8, Failure>, quiet: bool) -> u8 {
    match outcome {
        Ok(code) => code,
        Err(failure) => {
            if !quiet {
                // A reader that has gone does not change the exit code.
                let message = printable(&failure.message, MOST_LINES);
                let _ = writeln!(std::io::stderr(), "error: {message}");
            }
            failure.code
        }
    }
}

/// Prints to standard output. A reader that has gone, or a full disk behind it, changes nothing that was
/// done: the result and the exit code stand.
pub(crate) fn say(text: &str) {
    let _ = deliver(text);
}

/// Prints what a command is for: that it cannot be written is a failure, unless the reader has gone.
pub(crate) fn deliver(text: &str) -> Result<(), Failure> {
    let text = printable(text, usize::MAX);
    match writeln!(std::io::stdout(), "{text}") {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::write(Path::new("to standard output"), e))
        }
        _ => Ok(()),
    }
}

/// Says which files of somebody else are no more, since `--force` was there.
pub(crate) fn say_replaced(finished: &Finished, quiet: bool) {
    if let Some(message) = finished.replaced_message().filter(|_| !quiet) {
        say(&message);
    }
}

/// Lines of an error, and characters of a line.
const MOST_LINES: usize = 20;
const LONGEST_LINE: usize = 2000;

/// Text of at most so many lines, in characters that a terminal takes as they are: names of files and what
/// stands in them come from anywhere.
fn printable(text: &str, lines: usize) -> String {
    let mut all = text.split('\n');
    let shown = all
        .by_ref()
        .take(lines)
        .map(|line| shown(line, LONGEST_LINE));
    let mut shown: Vec<String> = shown.collect();
    if all.next().is_some() {
        shown.push("…".to_owned());
    }
    shown.join("\n")
}
