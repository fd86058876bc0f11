//! The result of an import, and notes on omissions.

use etendue_world::World;
use std::fmt;
use std::path::Path;

/// A message about a position in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// The file, as the scene names it.
    pub file: String,
    /// Line number, counted from 1; 0 if the message concerns the file as a whole.
    pub line: usize,
    /// Column in characters, counted from 1.
    pub column: usize,
    /// The message.
    pub message: String,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            file,
            line,
            column,
            message,
        } = self;
        match line {
            0 => write!(f, "{file}: {message}"),
            _ => write!(f, "{file}:{line}:{column}: {message}"),
        }
    }
}

/// An imported scene.
#[derive(Clone, Debug)]
pub struct Imported {
    /// The world.
    pub world: World,
    /// Notes on omissions and approximations, in the order of reading; if there are too many notes,
    /// the last note states the number of further notes.
    pub notes: Vec<Note>,
}

/// The reasons why a scene is refused: all causes at once.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refused {
    /// The causes, at least one, in the order of reading.
    pub causes: Vec<Note>,
    /// Whether the free memory of the machine did not suffice to read the scene.
    pub lacks_memory: bool,
}

impl Refused {
    /// Creates a refusal with one cause that concerns a file as a whole.
    pub(crate) fn because(file: &Path, message: impl Into<String>) -> Self {
        let cause = Note {
            file: file.display().to_string(),
            line: 0,
            column: 0,
            message: message.into(),
        };
        Self {
            causes: vec![cause],
            lacks_memory: false,
        }
    }
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, cause) in self.causes.iter().enumerate() {
            let end = if i == 0 { "" } else { "\n" };
            write!(f, "{end}{cause}")?;
        }
        Ok(())
    }
}

impl std::error::Error for Refused {}
