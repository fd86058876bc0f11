use crate::fault::Fault;
use std::io;
use std::path::{Path, PathBuf};

/// Why a file does not make a mesh.
#[derive(Debug, thiserror::Error)]
pub enum MeshError {
    /// The system does not give the file's content.
    #[error("{} cannot be read: {source}", file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// Something in the file cannot be used.
    #[error("{}: {fault}", file.display())]
    Value {
        /// The file.
        file: PathBuf,
        /// Where in the file, what is there, and what is allowed.
        fault: Fault,
    },
}

impl MeshError {
    pub(super) fn value(file: &Path, fault: Fault) -> Self {
        let file = file.into();
        Self::Value { file, fault }
    }
}

pub(super) fn fault(
    place: impl Into<String>,
    value: impl ToString,
    allowed: impl Into<String>,
) -> Fault {
    Fault {
        field: place.into(),
        value: value.to_string(),
        allowed: allowed.into(),
        memory: false,
    }
}
