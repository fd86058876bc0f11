//! The reason why a command stops, and its exit code.

use etendue_scene::SceneError;
use std::fmt::Display;
use std::path::Path;

/// The reason why a command stopped, with the message for the user and the exit code.
#[derive(Debug)]
pub struct Failure {
    /// The message for the user, one line for each fault.
    pub message: String,
    /// The exit code, which is 2 for bad input, and 3 if the command cannot run on this machine.
    pub code: u8,
}

/// Exit code of bad input.
const BAD_INPUT: u8 = 2;
/// Exit code of a run that this machine cannot carry out: because of a folder, the disk, the memory
/// or an interruption.
pub const CANNOT_RUN: u8 = 3;

impl Failure {
    /// Returns the failure for wrong input of the user, with exit code 2.
    pub fn bad_input(message: impl Display) -> Self {
        Self {
            message: message.to_string(),
            code: BAD_INPUT,
        }
    }

    /// Returns the failure for a request that cannot be carried out on this machine, with exit
    /// code 3.
    pub fn cannot_run(message: impl Display) -> Self {
        Self {
            message: message.to_string(),
            code: CANNOT_RUN,
        }
    }

    /// Returns the failure for a scene that is invalid, or valid but too large for this machine.
    pub fn of_scene(error: &SceneError, message: impl Display) -> Self {
        match error {
            SceneError::Values(faults) if faults.iter().all(|f| f.memory) => {
                Self::cannot_run(message)
            }
            _ => Self::bad_input(message),
        }
    }

    /// Returns the failure for a result file or folder `path` that could not be written.
    pub fn write(path: &Path, reason: impl Display) -> Self {
        Self::cannot_run(format!("cannot write {}: {reason}", path.display()))
    }
}
