//! New files take the place of earlier ones.
//!
//! Before the first one moves, all are whole and synced and their index is ready beside them: so whatever ends
//! this process, the next one into the folder can go on. Each step may have been done already.

use super::{Results, TIMING, UNFINISHED, has_hash, is_regular, listed, parents, sealed_bytes};
use crate::failure::Failure;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use tempfile::TempPath;

impl Results {
    /// Puts everything in its place; returns the names of earlier files that are there no more, and of files of
    /// somebody else that were replaced.
    pub(super) fn commit(&self) -> Result<(Vec<String>, Vec<String>), Failure> {
        let index = self.plan.index;
        let (waiting, ready) = (self.staged(index), self.ready(index));
        let failure = |e| Failure::write(&self.shown, e);
        sync(&self.folder.join(UNFINISHED)).map_err(failure)?;
        fs::rename(&waiting, &ready).map_err(failure)?;
        self.move_all(index).map_err(failure)
    }

    /// Ends what a dead process began to move, and removes what it left.
    pub(super) fn recover(&self) -> Result<(), Failure> {
        let failure = |e| Failure::write(&self.shown, e);
        if let Some(index) = self.ready_index() {
            self.move_all(index).map_err(failure)?;
        }
        match fs::remove_dir_all(self.folder.join(UNFINISHED)) {
            Err(e) if e.kind() != io::ErrorKind::NotFound => Err(failure(e)),
            _ => Ok(()),
        }
    }

    fn move_all(&self, index: &str) -> io::Result<(Vec<String>, Vec<String>)> {
        let ready = self.ready(index);
        let new = listed(&ready).unwrap_or_default();
        let mut replaced = Vec::new();

        // From here on the folder is no result, until the new index comes.
        let (place, old) = (
            self.folder.join(index),
            self.folder.join(UNFINISHED).join("old"),
        );
        if listed(&place).is_some() {
            fs::rename(&place, &old)?;
        }
        let earlier = listed(&old).unwrap_or_default();
        let waits = |name: &str| is_regular(&self.staged(name));
        let mut gone = Vec::new();
        for (name, hash) in &earlier {
            let was_moved = new.contains_key(name) && !waits(name);
            let path = self.inside(name).filter(|path| has_hash(path, hash));
            if let Some(path) = path.filter(|_| !was_moved) {
                fs::remove_file(path)?;
                if !new.contains_key(name) {
                    gone.push(name.clone());
                }
            }
        }
        let timing = self.folder.join(TIMING);
        if waits(TIMING) && sealed_bytes(&timing).is_some() {
            fs::remove_file(timing)?;
        }
        let timing = TIMING.to_owned();
        for name in new.keys().chain([&timing]).filter(|name| waits(name)) {
            if self.place(&self.staged(name), name)? {
                replaced.push(name.clone());
            }
        }
        for folder in parents(earlier.keys()).into_iter().rev() {
            // One that still holds something stays.
            let _ = fs::remove_dir(self.folder.join(folder));
        }
        for folder in parents(new.keys()) {
            sync(&self.folder.join(folder))?;
        }
        sync(&self.folder)?;
        if self.place(&ready, index)? {
            replaced.push(index.to_owned());
        }
        sync(&self.folder)?;
        fs::remove_dir_all(self.folder.join(UNFINISHED))?;
        Ok((gone, replaced))
    }

    /// Moves a file to a name where nothing stands; with `--force`, also where a file of somebody else does,
    /// which it tells.
    fn place(&self, from: &Path, name: &str) -> io::Result<bool> {
        let in_the_way = || io::Error::other(format!("something has come to stand at {name}"));
        let to: PathBuf = self.inside(name).ok_or_else(in_the_way)?;
        if let Some(folder) = to.parent() {
            fs::create_dir_all(folder)?;
        }
        let is_replaced = self.plan.force && is_regular(&to);
        if is_replaced {
            fs::remove_file(&to)?;
        }
        let mut from = TempPath::try_from_path(from)?;
        from.disable_cleanup(true);
        match from.persist_noclobber(&to) {
            Ok(()) => Ok(is_replaced),
            Err(e) if e.error.kind() == io::ErrorKind::AlreadyExists => Err(in_the_way()),
            Err(e) => Err(e.error),
        }
    }
}

/// Makes the names in a folder as lasting as its files, where folders can be synced.
fn sync(folder: &Path) -> io::Result<()> {
    if cfg!(unix) {
        File::open(folder)?.sync_all()?;
    }
    Ok(())
}
