//! Printing for commands, in characters that are safe on a terminal.

use etendue_scene::shown;
use etendue_store::{Failure, Finished};
use std::io::{ErrorKind, Write};
use std::path::Path;

/// Prints to standard output. A closed pipe or a full disk changes neither the result nor the exit
/// code.
pub(crate) fn say(text: &str) {
    let _ = deliver(text);
}

/// Prints the main output of a command: failing to write it is an error, unless the reader has
/// closed the pipe.
pub(crate) fn deliver(text: &str) -> Result<(), Failure> {
    let text = printable(text, usize::MAX);
    match writeln!(std::io::stdout(), "{text}") {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::write(Path::new("to standard output"), e))
        }
        _ => Ok(()),
    }
}

/// Names the files of others that were replaced because of `--force`.
pub(crate) fn say_replaced(finished: &Finished, quiet: bool) {
    if let Some(message) = finished.replaced_message().filter(|_| !quiet) {
        say(&message);
    }
}

/// Maximum number of lines of an error.
pub(crate) const MAX_ERROR_LINES: usize = 20;
const MAX_LINE_LENGTH: usize = 2000;

/// Text cut to so many lines, in characters that are safe on a terminal: file names and their
/// content may hold anything.
pub(crate) fn printable(text: &str, lines: usize) -> String {
    let mut all = text.split('\n');
    let shown = all
        .by_ref()
        .take(lines)
        .map(|line| shown(line, MAX_LINE_LENGTH));
    let mut shown: Vec<String> = shown.collect();
    if all.next().is_some() {
        shown.push("…".to_owned());
    }
    shown.join("\n")
}
