//! The reason why a command stops, and its exit code.

use etendue_scene::SceneError;
use std::fmt::Display;
use std::path::Path;

/// The reason why a request was not carried out, with the message for the user.
#[derive(Debug)]
pub struct Failure {
    /// The message for the user, one line for each fault.
    pub message: String,
    /// Whose fault it is.
    pub kind: FailureKind,
}

/// The kinds of [`Failure`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FailureKind {
    /// The input of the user is wrong.
    BadInput,
    /// This machine cannot carry out the request: because of a folder, the disk, the memory or an
    /// interruption.
    CannotRun,
}

impl Failure {
    /// The failure for wrong input of the user.
    pub fn bad_input(message: impl Display) -> Self {
        Self {
            message: message.to_string(),
            kind: FailureKind::BadInput,
        }
    }

    /// The failure for a request that cannot be carried out on this machine.
    pub fn cannot_run(message: impl Display) -> Self {
        Self {
            message: message.to_string(),
            kind: FailureKind::CannotRun,
        }
    }

    /// The failure for a scene that is invalid, or valid but too large for this machine.
    pub fn of_scene(error: &SceneError, message: impl Display) -> Self {
        match error {
            SceneError::Values(faults) if faults.iter().all(|f| f.memory) => {
                Self::cannot_run(message)
            }
            _ => Self::bad_input(message),
        }
    }

    /// The failure for a result file or folder `path` that could not be written.
    pub fn write(path: &Path, reason: impl Display) -> Self {
        Self::cannot_run(format!("cannot write {}: {reason}", path.display()))
    }
}
