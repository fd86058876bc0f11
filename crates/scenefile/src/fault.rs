//! The faults of a scene file.

use crate::limits;
use crate::place::{find, steps};
use std::fmt;

/// A value that cannot be used: its field, the value, and what is allowed there.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Fault {
    /// Path of the field, such as `blockers[0].fill`.
    pub field: String,
    /// The value found.
    pub value: String,
    /// What is allowed.
    pub allowed: String,
    /// Whether the scene is valid but too large for this machine.
    pub memory: bool,
}

/// Returns a fault of a file: the place in it, the text found, and what is allowed.
#[must_use]
pub fn fault(place: impl Into<String>, value: impl ToString, allowed: impl Into<String>) -> Fault {
    Fault {
        field: place.into(),
        value: value.to_string(),
        allowed: allowed.into(),
        memory: false,
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            field,
            value,
            allowed,
            ..
        } = self;
        let two = field.split_once(" and ");
        let is_two = two.is_some_and(|(a, b)| !a.contains(' ') && !b.contains(' '));
        let is = if is_two { "are" } else { "is" };
        write!(f, "{field} {is} {value}; allowed: {allowed}")
    }
}

/// The reason why a scene file cannot be resolved to a scene.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The text is not a scene file; the message gives line, column and what is allowed there.
    #[error("line {line}, column {column}: {message}")]
    Syntax {
        /// Line, from 1.
        line: usize,
        /// Column in characters, from 1.
        column: usize,
        /// What is wrong and what is allowed.
        message: String,
    },
    /// An override names no field, or has a value of the wrong kind.
    #[error("{path}: {message}")]
    Override {
        /// The path of the field, as the user wrote it.
        path: String,
        /// What is wrong.
        message: String,
    },
    /// All values outside their range; the first ten are shown, with the total number.
    #[error("{}", list(.0))]
    Values(Vec<Fault>),
}

impl SceneError {
    /// Returns the error in words, one line for each fault with its place. The place is a line and
    /// column of the scene file. For a field that was set by an argument, it is this argument,
    /// such as `--set run.photons=3`.
    #[must_use]
    pub fn in_text(&self, text: &str, set: &[(String, String)]) -> String {
        match self {
            Self::Values(faults) => lines(faults, |fault| {
                let field = steps(&fault.field);
                let mut set = set.iter().rev();
                let by = set.find(|(path, _)| field.starts_with(&steps(path)));
                match (by, find(text, &fault.field)) {
                    (Some((_, by)), _) => format!("{by}: {fault}"),
                    (None, Some(at)) => {
                        format!("line {}, column {}: {fault}", at.line, at.column)
                    }
                    _ => fault.to_string(),
                }
            })
            .join("\n"),
            _ => self.to_string(),
        }
    }
}

fn list(faults: &[Fault]) -> String {
    lines(faults, Fault::to_string).join("\n")
}

/// Returns the first faults in words, and the number of further faults.
fn lines(faults: &[Fault], told: impl Fn(&Fault) -> String) -> Vec<String> {
    let first = faults.iter().take(limits::FAULTS);
    let mut lines: Vec<String> = first.map(told).collect();
    let more = faults.len() - lines.len();
    if more > 0 {
        lines.push(format!("and {more} more: {} faults in all", faults.len()));
    }
    lines
}
