//! Writes a single output file that the user chooses, such as a picture or a table.

use crate::Failure;
use crate::file_seal::SealKind;
use crate::lock::Lock;
use etendue_scene::read_file;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use tempfile::TempPath;

/// The largest size of a file that is read to check whether this program wrote it.
const MAX_SEALED_BYTES: u64 = 1 << 30;

/// An output file that appears at its path only when it is complete.
#[derive(Debug)]
pub struct OutputFile {
    path: PathBuf,
    force: bool,
    seal: Option<SealKind>,
    /// The temporary file that becomes the output.
    lock: Lock,
}

impl OutputFile {
    /// Checks that the file can be written, before any work is done. An existing file at the path
    /// is kept, unless `force` is set and the file is regular. The path must not be among
    /// `inputs`, even with `force`.
    pub fn claim(path: &Path, force: bool, inputs: &[PathBuf]) -> Result<Self, Failure> {
        Self::of_kind(path, force, inputs, None)
    }

    /// Performs the same checks as [`Self::claim`], for a file that bears a mark. A file that
    /// this program wrote and that has not changed since is replaced without `force`.
    pub fn claim_sealed(
        path: &Path,
        mut force: bool,
        inputs: &[PathBuf],
        kind: SealKind,
    ) -> Result<Self, Failure> {
        let is_file = fs::symlink_metadata(path).is_ok_and(|found| found.is_file());
        if is_file && !force {
            let bytes = read_file(path, MAX_SEALED_BYTES).unwrap_or_default();
            force = kind.is_sealed(&bytes);
        }
        Self::of_kind(path, force, inputs, Some(kind))
    }

    fn of_kind(
        path: &Path,
        force: bool,
        inputs: &[PathBuf],
        seal: Option<SealKind>,
    ) -> Result<Self, Failure> {
        let failure = |e: io::Error| Failure::write(path, e);
        let Some(name) = path.file_name() else {
            return Err(Failure::write(path, "it does not name a file"));
        };
        match fs::symlink_metadata(path) {
            Err(_) => {}
            Ok(found) if !found.is_file() => {
                return Err(Failure::write(path, "it exists and is not a regular file"));
            }
            Ok(_) => {
                let there = path.canonicalize().map_err(failure)?;
                let is_read = |input: &PathBuf| input.canonicalize().is_ok_and(|i| i == there);
                if inputs.iter().any(is_read) {
                    return Err(Failure::bad_input(format!(
                        "{} is read by this command: choose another file to write",
                        path.display()
                    )));
                }
                if !force {
                    return Err(Failure::write(
                        path,
                        match seal {
                            None => "the file exists; --force replaces it",
                            Some(_) => {
                                "the file exists; either etendue did not write it, or it was changed \
                                 afterwards. --force replaces it"
                            }
                        },
                    ));
                }
            }
        }
        let waiting = format!(".{}.etendue-unfinished", name.to_string_lossy());
        let lock = Lock::take(&path.with_file_name(waiting), path)?;
        Ok(Self {
            path: path.to_owned(),
            force,
            seal,
            lock,
        })
    }

    /// Writes the complete file.
    pub fn write(mut self, bytes: &[u8]) -> Result<(), Failure> {
        let mut write = || -> io::Result<()> {
            self.lock.file.set_len(0)?;
            match self.seal {
                Some(kind) => self.lock.file.write_all(&kind.sealed(bytes))?,
                None => self.lock.file.write_all(bytes)?,
            }
            self.lock.file.sync_all()?;
            // The lock must not remove a file that has been moved.
            let waiting = TempPath::try_from_path(std::mem::take(&mut self.lock.path))?;
            let moved = if self.force {
                waiting.persist(&self.path)
            } else {
                waiting.persist_noclobber(&self.path)
            };
            moved.map_err(|e| e.error)
        };
        write().map_err(|e| Failure::write(&self.path, e))
    }
}
