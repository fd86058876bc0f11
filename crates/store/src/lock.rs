//! A lock that admits one writer at a time. The system releases the lock when the writer's process
//! ends.

use crate::Failure;
use same_file::Handle;
use std::fs::{self, File, TryLockError};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// The reason why a folder cannot be locked.
pub(super) const BUSY: &str = "another etendue process is writing there";

/// The number of times that a file may be replaced while it is being locked.
const TRIES: usize = 100;

/// A locked file, which is removed together with the lock.
#[derive(Debug)]
pub(crate) struct Lock {
    pub(crate) path: PathBuf,
    pub(crate) file: File,
}

impl Lock {
    /// Makes and locks the file `path`, or takes over the file of a dead process. If a living
    /// process holds the lock, the message names the path `busy`.
    pub(crate) fn take(path: &Path, busy: &Path) -> Result<Self, Failure> {
        let failure = |error: io::Error| Failure::write(busy, error);
        for _ in 0..TRIES {
            let mut options = File::options();
            let options = options.read(true).write(true).create(true).truncate(false);
            if fs::symlink_metadata(path).is_ok_and(|found| !found.is_file()) {
                return Err(Failure::write(path, "it exists and is not a regular file"));
            }
            let file = options.open(path).map_err(failure)?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => {
                    return Err(Failure::write(busy, BUSY));
                }
                Err(TryLockError::Error(error)) => return Err(failure(error)),
            }
            let mut lock = Self {
                path: path.to_owned(),
                file,
            };
            // Another process may remove the file after it is opened and before it is locked; the
            // lock is then useless.
            let held = lock.file.try_clone().and_then(Handle::from_file);
            let held = held.map_err(failure)?;
            match Handle::from_path(path) {
                Ok(there) if held == there => return Ok(lock),
                Err(error) if error.kind() != ErrorKind::NotFound => return Err(failure(error)),
                // The file that may be there now belongs to another process.
                _ => lock.path = PathBuf::new(),
            }
        }
        Err(Failure::write(busy, BUSY))
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // Failure is ignored, because a file that remains is harmless.
        let _ = fs::remove_file(&self.path);
    }
}
