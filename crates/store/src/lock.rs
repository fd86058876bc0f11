//! A lock that admits one writer at a time. The system releases the lock when the writer's process
//! ends.

use crate::Failure;
use same_file::Handle;
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

/// The reason why a folder cannot be locked.
pub(super) const BUSY: &str = "another etendue process is writing there";

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
        loop {
            let mut options = File::options();
            let options = options.read(true).write(true).create(true).truncate(false);
            if path.is_symlink() {
                return Err(Failure::write(
                    path,
                    "it is a link; allowed: a regular file",
                ));
            }
            let file = options.open(path).map_err(failure)?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => {
                    return Err(Failure::write(busy, BUSY));
                }
                Err(TryLockError::Error(error)) => return Err(failure(error)),
            }
            // Another process may remove the file after it is opened and before it is locked; the
            // lock is then useless.
            let held = Handle::from_file(file.try_clone().map_err(failure)?);
            if Handle::from_path(path).is_ok_and(|there| held.is_ok_and(|held| held == there)) {
                let path = path.to_owned();
                return Ok(Self { path, file });
            }
        }
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // Failure is ignored, because a file that remains is harmless.
        let _ = fs::remove_file(&self.path);
    }
}
