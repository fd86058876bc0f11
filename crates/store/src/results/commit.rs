//! Replaces earlier files by new files.
//!
//! Before the first file moves, all files are complete and synced, and their index is ready beside
//! them. If this process ends at any step, the next process that writes to the folder can therefore
//! continue. Earlier files are first moved aside, and are removed at the end, so all moves can be
//! undone if one move fails.

use super::{
    LINKED, Results, TIMING, UNFINISHED, bears_mark, has_hash, is_regular, listed, parents,
};
use crate::{ArgumentStyle, Failure};
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use tempfile::TempPath;

/// Files that no longer exist.
#[derive(Debug, Default)]
pub(super) struct MovedFiles {
    /// Files of the earlier result.
    pub(super) gone: Vec<String>,
    /// Files that etendue did not write.
    pub(super) replaced: Vec<String>,
    /// All moves so far, which are undone on failure.
    done: Vec<[PathBuf; 2]>,
    /// The style in which messages name arguments.
    arguments: ArgumentStyle,
}

impl MovedFiles {
    /// Moves a file to an unused path.
    fn file(&mut self, from: PathBuf, to: PathBuf) -> Result<(), Failure> {
        let moved = || {
            if let Some(folder) = to.parent() {
                fs::create_dir_all(folder)?;
            }
            let mut file = TempPath::try_from_path(&from)?;
            file.disable_cleanup(true);
            file.persist_noclobber(&to).map_err(|e| e.error)
        };
        moved().map_err(|e| {
            let what = match e.kind() {
                io::ErrorKind::AlreadyExists => {
                    let force = self.arguments.force();
                    format!("a file has appeared there; move it away, or replace it with {force}")
                }
                _ => e.to_string(),
            };
            let [from, to] = [&from, &to].map(|path| path.display());
            Failure::cannot_run(format!("cannot move {from} to {to}: {what}"))
        })?;
        self.done.push([from, to]);
        Ok(())
    }

    /// Moves everything back.
    fn undo(&self) {
        for [from, to] in self.done.iter().rev() {
            // If a file cannot be moved back, the next process completes its move.
            let _ = fs::rename(to, from);
        }
    }
}

impl Results {
    /// Moves all new files to their names.
    pub(super) fn commit(&self) -> Result<MovedFiles, Failure> {
        let index = self.plan.index;
        let ready = self.ready(index);
        let failure = |e| Failure::write(&self.shown, e);
        sync(&self.folder.join(UNFINISHED)).map_err(failure)?;
        fs::rename(self.staged(index), &ready).map_err(failure)?;
        self.move_all(index).inspect_err(|_| {
            if !self.aside("").exists() {
                // All moves are undone, so the next process has nothing to complete.
                let _ = fs::remove_file(&ready);
            }
        })
    }

    /// Completes the moves that a dead process began, and removes files that the dead process left.
    pub(super) fn recover(&self) -> Result<MovedFiles, Failure> {
        let moved = match self.ready_index() {
            Some(index) => self.move_all(index)?,
            None => MovedFiles::default(),
        };
        let left = self.folder.join(UNFINISHED);
        match fs::remove_dir_all(&left) {
            Err(e) if e.kind() != io::ErrorKind::NotFound => Err(Failure::write(&left, e)),
            _ => Ok(moved),
        }
    }

    fn move_all(&self, index: &str) -> Result<MovedFiles, Failure> {
        let mut moved = MovedFiles {
            arguments: self.plan.arguments,
            ..MovedFiles::default()
        };
        let result = self.moves(index, &mut moved);
        if let Err(error) = result {
            moved.undo();
            // The folder is now empty, unless a file could not be moved back or an earlier
            // process had moved a file there.
            remove_empty(&self.aside(""));
            return Err(error);
        }
        let earlier = listed(&self.aside(index)).unwrap_or_default();
        for folder in parents(earlier.keys()).into_iter().rev() {
            // A folder that is not empty is kept.
            let _ = fs::remove_dir(self.folder.join(folder));
        }
        let finished = || {
            sync(&self.folder)?;
            fs::remove_dir_all(self.folder.join(UNFINISHED))
        };
        finished().map_err(|e| Failure::write(&self.shown, e))?;
        Ok(moved)
    }

    fn moves(&self, index: &str, moved: &mut MovedFiles) -> Result<(), Failure> {
        let ready = self.ready(index);
        let new = listed(&ready).unwrap_or_default();
        // From this step on, the folder holds no valid result until the new index is in place.
        let place = self.folder.join(index);
        if listed(&place).is_some() {
            moved.file(place, self.aside(index))?;
        }
        let earlier = listed(&self.aside(index)).unwrap_or_default();
        let waits = |name: &str| is_regular(&self.staged(name));
        for (name, hash) in &earlier {
            let was_moved = new.contains_key(name) && !waits(name);
            let path = self.inside(name).filter(|path| has_hash(path, hash));
            if let Some(path) = path.filter(|_| !was_moved) {
                moved.file(path, self.aside(name))?;
                if !new.contains_key(name) {
                    moved.gone.push(name.clone());
                }
            }
        }
        let timing = TIMING.to_owned();
        for name in new.keys().chain([&timing]).filter(|name| waits(name)) {
            self.place(self.staged(name), name, moved)?;
        }
        let failure = |e| Failure::write(&self.shown, e);
        for folder in parents(new.keys()) {
            sync(&self.folder.join(folder)).map_err(failure)?;
        }
        sync(&self.folder).map_err(failure)?;
        self.place(ready, index, moved)
    }

    /// Moves a new file to its name. A file that bears a mark is first moved aside; with `force`,
    /// also a file that etendue did not write.
    fn place(&self, from: PathBuf, name: &str, moved: &mut MovedFiles) -> Result<(), Failure> {
        let to = self.inside(name).ok_or_else(|| {
            let shown = self.shown.join(name);
            Failure::write(&shown, LINKED)
        })?;
        let is_own = bears_mark(name, &to);
        if is_own || self.plan.force && is_regular(&to) {
            let replaced = self.folder.join(UNFINISHED).join("replaced");
            moved.file(to.clone(), replaced.join(name))?;
            if !is_own {
                moved.replaced.push(name.to_owned());
            }
        }
        moved.file(from, to)
    }

    /// The path to which an earlier file is moved before it is removed.
    fn aside(&self, name: &str) -> PathBuf {
        self.folder.join(UNFINISHED).join("old").join(name)
    }
}

/// Removes a folder and its subfolders if they contain no files.
fn remove_empty(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        remove_empty(&entry.path());
    }
    let _ = fs::remove_dir(folder);
}

/// Syncs a folder, so that renamed files survive a crash, on systems that can sync folders.
fn sync(folder: &Path) -> io::Result<()> {
    if cfg!(unix) {
        File::open(folder)?.sync_all()?;
    }
    Ok(())
}
