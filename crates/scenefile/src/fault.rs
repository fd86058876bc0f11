//! The faults of a scene file.

use crate::limits;
use crate::place::{find, steps};
use std::fmt;

/// A value that cannot be used, with its field and a description of the allowed values.
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

/// A fault of a file, with its position, the text at this position, and what is allowed
/// there.
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
    /// The text is not a scene file; the message gives the line, the column and what is allowed
    /// there.
    #[error("line {line}, column {column}: {message}")]
    Syntax {
        /// Line, from 1.
        line: usize,
        /// Column of the fault in characters, counted from 1.
        column: usize,
        /// A description of the fault, and of what is allowed instead.
        message: String,
    },
    /// An override names a field that does not exist, or has a value of the wrong kind.
    #[error("{path}: {message}")]
    Override {
        /// The path of the field, as the user wrote it.
        path: String,
        /// What is wrong.
        message: String,
    },
    /// All values outside their allowed range; a message shows the first ten of them, and their
    /// total number.
    #[error("{}", list(.0))]
    Values(Vec<Fault>),
}

impl SceneError {
    /// The error in words, with one line for each fault and its position. The position of a
    /// fault is a line and a column of the scene file. If an argument such as `--set run.photons=3`
    /// has set the field, the argument is shown as the position.
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

/// Returns descriptions of the first faults, and the number of further faults.
fn lines(faults: &[Fault], told: impl Fn(&Fault) -> String) -> Vec<String> {
    let first = faults.iter().take(limits::FAULTS);
    let mut lines: Vec<String> = first.map(told).collect();
    let more = faults.len() - lines.len();
    if more > 0 {
        lines.push(format!("and {more} more: {} faults in all", faults.len()));
    }
    lines
}
