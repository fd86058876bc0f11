//! Printing for commands, in characters that are safe on a terminal.

use clap::builder::styling::AnsiColor;
use etendue_scene::shown;
use etendue_store::{Failure, Finished};
use std::io::{ErrorKind, IsTerminal, Write, stderr, stdout};
use std::path::Path;

/// Prints to standard output. A closed pipe or a full disk does not change the result or the exit
/// code.
pub(crate) fn say(text: &str) {
    let _ = deliver(text);
}

/// Prints the main output of a command. If the output cannot be written, the function fails. It
/// does not fail if the program at the other end has closed the pipe.
pub(crate) fn deliver(text: &str) -> Result<(), Failure> {
    let text = printable(text, usize::MAX);
    let text = if stdout().is_terminal() {
        wrapped(&text)
    } else {
        text
    };
    written(writeln!(anstream::stdout(), "{}", colored(&text)))
}

/// Writes bytes to standard output; fails as [`deliver`] does.
pub(crate) fn deliver_bytes(bytes: &[u8]) -> Result<(), Failure> {
    written(stdout().write_all(bytes))
}

/// Prints JSON. Characters that are not safe on a terminal are escaped; in JSON, they occur only in
/// strings.
pub(crate) fn deliver_json(text: &str) -> Result<(), Failure> {
    let mut safe = String::with_capacity(text.len() + 1);
    for c in text.trim_end().chars() {
        if c == '\n' || shown(c, usize::MAX).starts_with(c) {
            safe.push(c);
        } else {
            for unit in c.encode_utf16(&mut [0; 2]) {
                safe.push_str(&format!("\\u{unit:04x}"));
            }
        }
    }
    safe.push('\n');
    deliver_bytes(safe.as_bytes())
}

/// Prints a JSON file that the program has written.
pub(crate) fn deliver_json_file(path: &Path) -> Result<(), Failure> {
    let text = std::fs::read_to_string(path);
    let text =
        text.map_err(|e| Failure::cannot_run(format!("cannot read {}: {e}", path.display())));
    deliver_json(&text?)
}

fn written(outcome: std::io::Result<()>) -> Result<(), Failure> {
    match outcome {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::write(Path::new("to standard output"), e))
        }
        _ => Ok(()),
    }
}

/// A text with its verdicts in colour: the word after `verdict: `, and the last word of the
/// row of a table.
fn colored(text: &str) -> String {
    let line = |line: &str| {
        let start = match line.strip_prefix("verdict: ") {
            Some(_) => "verdict: ".len(),
            None => line.rfind("  ").map_or(0, |at| at + 2),
        };
        let (before, rest) = line.split_at(start);
        let end = rest.find(|c: char| !c.is_ascii_alphabetic());
        let (word, after) = rest.split_at(end.unwrap_or(rest.len()));
        let color = match word {
            "pass" | "same" => AnsiColor::Green,
            "fail" | "different" => AnsiColor::Red,
            "undecided" => AnsiColor::Yellow,
            _ => return line.to_owned(),
        };
        let style = color.on_default();
        format!("{before}{style}{word}{style:#}{after}")
    };
    text.split('\n').map(line).collect::<Vec<_>>().join("\n")
}

/// Prints a message to standard error; a failure to print is ignored.
pub(crate) fn tell(message: &str) {
    let message = if stderr().is_terminal() {
        wrapped(message)
    } else {
        message.to_owned()
    };
    let _ = writeln!(stderr(), "{message}");
}

/// The maximum number of columns on a terminal. Longer lines are wrapped. If standard error is not
/// a terminal, each message is written on one line.
const COLUMNS: usize = 100;

/// Wraps sentences between words and indents continued lines. Rows of tables, whose columns are
/// two spaces apart, are not wrapped.
fn wrapped(text: &str) -> String {
    let lines = text.lines().map(|line| {
        let start = line.len() - line.trim_start().len();
        let (indent, words) = line.split_at(start);
        if line.chars().count() <= COLUMNS || words.contains("  ") {
            return line.to_owned();
        }
        let mut all = indent.to_owned();
        let mut column = start;
        for (i, word) in words.split(' ').enumerate() {
            let length = word.chars().count();
            if i > 0 && column + 1 + length > COLUMNS {
                all.push_str(&format!("\n{indent}  "));
                column = start + 2;
            } else if i > 0 {
                all.push(' ');
                column += 1;
            }
            all.push_str(word);
            column += length;
        }
        all
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// Prints the names of the files that were replaced only because of `--force`.
pub(crate) fn say_replaced(finished: &Finished, quiet: bool) {
    if let Some(message) = finished.replaced_message().filter(|_| !quiet) {
        say(&message);
    }
}

/// The maximum number of lines of an error message.
pub(crate) const MAX_ERROR_LINES: usize = 20;
const MAX_LINE_LENGTH: usize = 2000;

/// Cuts a text to `lines` lines, and escapes characters that are not safe on a terminal. Names and
/// contents of files may hold such characters.
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

#[cfg(test)]
mod tests {
    use super::{COLUMNS, wrapped};

    #[test]
    fn sentences_are_wrapped_and_tables_are_not() {
        let sentence = format!("  {}", "words of a long message ".repeat(9).trim_end());
        let lines = wrapped(&sentence);
        assert!(lines.lines().count() > 1);
        assert!(lines.lines().all(|line| line.chars().count() <= COLUMNS));
        let words = |text: &str| {
            text.split_whitespace()
                .map(str::to_owned)
                .collect::<Vec<_>>()
        };
        assert_eq!(words(&lines), words(&sentence));
        let row = "cell  ".repeat(30) + "end";
        assert_eq!(wrapped(&format!("{row}\nshort")), format!("{row}\nshort"));
    }
}
