//! Reads files as bytes. Only regular files are read, and only if their length is within a limit. A
//! file that a scene names must also be below the scene's folder.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Component, Path};

/// The reason why a file is not read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The system cannot read the file.
    #[error("{0}")]
    Io(#[from] io::Error),
    /// The path names a folder, a pipe or a device; reading a pipe or a device might never end.
    #[error("not a regular file")]
    NotRegular,
    /// The path, with links followed, leads out of the scene's folder.
    #[error("outside of the required folder, after links are followed")]
    Outside,
    /// The file is longer than allowed.
    #[error("{length} bytes long; allowed: at most {most}")]
    TooLong {
        /// Length of the file, in bytes.
        length: u64,
        /// The maximum allowed length, in bytes.
        most: u64,
    },
}

/// The bytes of a regular file that has at most `most` bytes.
///
/// # Errors
/// [`ReadError`], except [`ReadError::Outside`].
pub fn read_file(path: &Path, most: u64) -> Result<Vec<u8>, ReadError> {
    // The kind of file is checked before opening, because opening a pipe would wait for the other
    // end.
    if !fs::metadata(path)?.is_file() {
        return Err(ReadError::NotRegular);
    }
    let file = File::open(path)?;
    let length = file.metadata()?.len();
    if length > most {
        return Err(ReadError::TooLong { length, most });
    }
    let mut bytes = Vec::new();
    // If a file grows while it is read, the reader stops one byte beyond the limit.
    file.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    match bytes.len() as u64 {
        length if length > most => Err(ReadError::TooLong { length, most }),
        _ => Ok(bytes),
    }
}

/// The bytes of the regular file `name`, which must be below `folder` after all links are
/// followed.
///
/// # Errors
/// [`ReadError`].
pub fn read_below(folder: &Path, name: &str, most: u64) -> Result<Vec<u8>, ReadError> {
    if !leads_down(name) {
        return Err(ReadError::Outside);
    }
    // If the path of the scene has no folder, `folder` is empty and means the current folder.
    let folder = match folder.as_os_str() {
        empty if empty.is_empty() => Path::new(".").canonicalize()?,
        _ => folder.canonicalize()?,
    };
    let path = folder.join(name).canonicalize()?;
    if !path.starts_with(&folder) {
        return Err(ReadError::Outside);
    }
    read_file(&path, most)
}

/// Checks whether a path, as written, is relative and has no component `..`.
pub(crate) fn leads_down(path: &str) -> bool {
    let mut components = Path::new(path).components();
    components.all(|c| matches!(c, Component::Normal(_)))
}
