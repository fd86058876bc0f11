use crate::limits;
use std::fmt;

/// A value that cannot be used: which, what it is, and what is allowed there.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Fault {
    /// Path of the field, such as `blockers[0].fill`.
    pub field: String,
    /// The value found.
    pub value: String,
    /// What is allowed.
    pub allowed: String,
    /// The scene is sound, but larger than this machine.
    pub memory: bool,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} is {}; allowed: {}",
            self.field, self.value, self.allowed
        )
    }
}

/// Why a scene file does not make a scene.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The text is no scene file; says line, column and what is allowed there.
    #[error("line {line}, column {column}: {message}")]
    Syntax {
        /// Line, from 1.
        line: usize,
        /// Column in characters, from 1.
        column: usize,
        /// What is wrong and what is allowed.
        message: String,
    },
    /// An override names no field, or gives it a value of the wrong kind.
    #[error("{path}: {message}")]
    Override {
        /// The path as given.
        path: String,
        /// What is wrong.
        message: String,
    },
    /// Values outside their range, all of them; the first ten are shown, and how many there are.
    #[error("{}", list(.0))]
    Values(Vec<Fault>),
}

fn list(faults: &[Fault]) -> String {
    let told = faults.iter().take(limits::FAULTS);
    let mut lines: Vec<String> = told.map(ToString::to_string).collect();
    let more = faults.len() - lines.len();
    if more > 0 {
        lines.push(format!("and {more} more: {} faults in all", faults.len()));
    }
    lines.join("\n")
}
