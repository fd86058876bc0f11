//! The reason why a ray file is refused, and the position of the fault.

use std::fmt;

/// A position in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilePosition {
    /// The file as a whole.
    File,
    /// An offset from the beginning of the unpacked file, in bytes from 0.
    Byte(u64),
    /// A ray, by its number, counted from 0.
    Ray(u64),
}

/// The reason why a file is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub struct Fault {
    /// Position of the fault.
    pub place: FilePosition,
    /// The value found at the position of the fault, and what is allowed there.
    pub message: String,
}

impl Fault {
    pub(crate) fn file(message: impl Into<String>) -> Self {
        let (place, message) = (FilePosition::File, message.into());
        Self { place, message }
    }

    pub(crate) fn byte(at: usize, message: impl Into<String>) -> Self {
        let (place, message) = (FilePosition::Byte(at as u64), message.into());
        Self { place, message }
    }

    pub(crate) fn ray(index: usize, message: impl Into<String>) -> Self {
        let (place, message) = (FilePosition::Ray(index as u64), message.into());
        Self { place, message }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.place {
            FilePosition::File => write!(f, "{}", self.message),
            FilePosition::Byte(at) => write!(f, "byte {at}: {}", self.message),
            FilePosition::Ray(index) => write!(f, "ray {index} (the first is 0): {}", self.message),
        }
    }
}
