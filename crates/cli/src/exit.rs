//! Determines how a command ends: its message and its exit code.

use crate::print::{MAX_ERROR_LINES, printable, tell};
use etendue_store::{Failure, FailureKind};
use std::io::ErrorKind;
use std::path::Path;

/// Prints a command-line error, or the requested help or version; returns the exit code.
pub(crate) fn not_parsed(error: &clap::Error) -> u8 {
    // Arguments may hold characters that are not safe on a terminal.
    let text = error.render().to_string();
    let safe = printable(text.trim_end(), usize::MAX);
    let printed = if error.use_stderr() && safe != text.trim_end() {
        tell(&safe);
        Ok(())
    } else {
        error.print()
    };
    match printed {
        Err(e) if !error.use_stderr() && e.kind() != ErrorKind::BrokenPipe => ended(
            Err(Failure::write(Path::new("to standard output"), e)),
            false,
        ),
        _ => u8::try_from(error.exit_code()).unwrap_or(2),
    }
}

/// The exit code of a command that failed.
pub(crate) const fn code_of(kind: FailureKind) -> u8 {
    match kind {
        FailureKind::BadInput => 2,
        FailureKind::CannotRun => 3,
    }
}

/// The exit code for the outcome of a command. Prints the message of a failure unless
/// `quiet` is set, because another process then prints this message.
pub(crate) fn ended(outcome: Result<u8, Failure>, quiet: bool) -> u8 {
    match outcome {
        Ok(code) => code,
        Err(failure) => {
            if !quiet {
                let message = printable(&failure.message, MAX_ERROR_LINES);
                tell(&format!("error: {message}"));
            }
            code_of(failure.kind)
        }
    }
}
