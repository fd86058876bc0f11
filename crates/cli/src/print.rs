//! What commands print, in characters that a terminal takes as they are.

use etendue_scene::shown;
use etendue_store::{Failure, Finished};
use std::io::{ErrorKind, Write};
use std::path::Path;

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
pub(crate) const MAX_ERROR_LINES: usize = 20;
const MAX_LINE_LENGTH: usize = 2000;

/// Text of at most so many lines, in characters that a terminal takes as they are: names of files and what
/// stands in them come from anywhere.
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
