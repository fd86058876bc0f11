//! Included and imported files.

use super::build::{Builder, DEEPEST_FILES, MOST_FILES};
use super::token::Tokens;
use crate::files::{Files, has_extension, text};
use crate::report::{SourcePlace, quoted};
use flate2::read::MultiGzDecoder;
use std::io::Read;
use std::path::Path;

impl Builder<'_> {
    /// Reads a file. `Include` reads a file as if the text of the file replaced the directive.
    /// After `Import`, the graphics state is restored, and only the objects that the file defines
    /// are kept.
    pub(super) fn include(
        &mut self,
        word: &str,
        name: &str,
        place: &SourcePlace,
    ) -> Result<(), String> {
        let told = |error: String| format!("file {} {error}", quoted(name));
        let folders = std::slice::from_ref(&self.folder);
        let path = self.files.find(folders, name).map_err(told)?;
        if self.open.contains(&path) {
            return Err(told("includes itself".to_owned()));
        }
        if self.open.len() >= DEEPEST_FILES {
            return Err(format!(
                "includes are nested more than {DEEPEST_FILES} deep"
            ));
        }
        self.included += 1;
        if self.included > MOST_FILES {
            return match self.included == MOST_FILES + 1 {
                true => Err(format!("more than {MOST_FILES} files are included")),
                // The cause of refusal for this file was already added.
                false => Ok(()),
            };
        }
        let text = read(self.files, &path).map_err(told)?;
        let before = (word == "Import").then(|| (self.state.clone(), self.stack.len()));
        if before.is_some() {
            self.require_world(word, true)?;
        }
        self.open.push(path);
        self.follow(&mut Tokens::new(&text, name));
        self.open.pop();
        if let Some((state, level)) = before {
            self.refuse_open(level);
            if self.stack.len() < level {
                let message = told("closes more blocks than it opens".to_owned());
                self.report.cause(place, message);
            }
            self.state = state;
        }
        Ok(())
    }
}

/// Returns the text of a file, unpacked if its name ends in .gz.
pub(super) fn read(files: &Files, path: &Path) -> Result<String, String> {
    text(bytes(files, path)?)
}

/// Returns the bytes of a file, unpacked if its name ends in .gz.
pub(super) fn bytes(files: &Files, path: &Path) -> Result<Vec<u8>, String> {
    let packed = files.read(path)?;
    if !has_extension(path, "gz") {
        return Ok(packed);
    }
    let most = files.left();
    let mut unpacked = Vec::new();
    let mut stream = MultiGzDecoder::new(packed.as_slice()).take(most.saturating_add(1));
    let read = stream.read_to_end(&mut unpacked);
    files.spend(unpacked.len() as u64)?;
    read.map_err(|error| format!("cannot be unpacked: {error}"))?;
    Ok(unpacked)
}
