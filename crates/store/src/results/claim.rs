//! Checks the content of a results folder before anything is written to it.

use super::{LINKED, Results, UNFINISHED, bears_mark, has_hash, inside, listed};
use crate::Failure;
use std::collections::{BTreeMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The largest number of names in a message.
const MAX_NAMES: usize = 10;

impl Results {
    /// The files of the earlier result, as listed in its index.
    pub(super) fn earlier(&self) -> BTreeMap<String, String> {
        listed(&self.folder.join(self.plan.index)).unwrap_or_default()
    }

    /// The path of a file of the folder. Returns `None` if the path leads out of the
    /// folder, through `..` or through a link.
    pub(super) fn inside(&self, name: &str) -> Option<PathBuf> {
        inside(&self.folder, name)
    }

    /// Refuses results whose files would replace inputs.
    pub(super) fn refuse_inputs(&self) -> Result<(), Failure> {
        let earlier = self.earlier();
        let earlier = earlier.keys().map(String::as_str);
        let written: HashSet<PathBuf> = self
            .planned()
            .chain(earlier)
            .map(|name| self.folder.join(name))
            .collect();
        for input in &self.plan.inputs {
            let Ok(canonical) = input.canonicalize() else {
                continue;
            };
            let waits = canonical.starts_with(self.folder.join(UNFINISHED));
            if waits || written.contains(&canonical) {
                return Err(Failure::bad_input(format!(
                    "{} is read by this command and would be replaced by the results in {}: choose another folder",
                    input.display(),
                    self.shown.display()
                )));
            }
        }
        Ok(())
    }

    /// Refuses to write if a file is in the way that etendue did not write. With `force`, refuses
    /// only if this file is not a regular file.
    pub(super) fn refuse_foreign(&self) -> Result<(), Failure> {
        let earlier = self.earlier();
        let mut foreign = Vec::new();
        for name in self.planned() {
            let shown = self.shown.join(name);
            let Some(path) = self.inside(name) else {
                return Err(Failure::write(&shown, LINKED));
            };
            match fs::symlink_metadata(&path) {
                Err(_) => {}
                Ok(found) if !found.is_file() => {
                    return Err(Failure::write(&shown, "it exists and is not a file"));
                }
                Ok(_) if self.is_own(name, &path, &earlier) => {}
                Ok(_) => foreign.push(name),
            }
        }
        if foreign.is_empty() || self.plan.force {
            return Ok(());
        }
        let told = foreign.iter().take(MAX_NAMES).copied().collect::<Vec<_>>();
        let more = match foreign.len() - told.len() {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        Err(Failure::cannot_run(format!(
            "{} holds files that etendue did not write, or that were changed after it wrote them: {}{more}; \
             choose another folder, or replace them with {}",
            self.shown.display(),
            told.join(", "),
            self.plan.arguments.force()
        )))
    }

    /// Checks whether a file belongs to an earlier result, and is unchanged.
    fn is_own(&self, name: &str, path: &Path, earlier: &BTreeMap<String, String>) -> bool {
        match earlier.get(name) {
            Some(hash) => has_hash(path, hash),
            None if name == self.plan.index => listed(path).is_some(),
            None => bears_mark(name, path),
        }
    }
}
