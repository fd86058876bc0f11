//! File search and included files of a scene.

use super::transform::{Attributes, allow, required};
use super::xml::{SourceFile, Tree};
use crate::report::quoted;
use std::path::Path;

/// Maximum nesting depth of included files.
const MOST_INCLUDED: usize = 15;
/// Maximum number of includes, counting repeats.
const MAX_INCLUDES: usize = 1000;
/// Maximum number of search folders.
const MOST_FOLDERS: usize = 64;

impl Tree<'_> {
    /// Adds a search folder before all other search folders.
    pub(super) fn search(
        &mut self,
        attributes: &Attributes,
        parent: usize,
        source: &mut SourceFile<'_>,
    ) -> Result<(), String> {
        allow(attributes, &["value"])?;
        if parent != 0 {
            return Err(
                "<path> is inside another element; allowed: directly in <scene>".to_owned(),
            );
        }
        let name = required(attributes, "value")?;
        let found = self.files.find(&source.folders, name);
        let folder = found.map_err(|error| format!("folder {} {error}", quoted(name)))?;
        if source.folders.len() > MOST_FOLDERS {
            return Err(format!("more than {MOST_FOLDERS} folders"));
        }
        let folders = std::iter::once(folder).chain(source.folders.iter().cloned());
        source.folders = folders.collect();
        Ok(())
    }

    pub(super) fn include(
        &mut self,
        attributes: &Attributes,
        parent: usize,
        source: &SourceFile<'_>,
        depth: usize,
    ) -> Result<(), String> {
        allow(attributes, &["filename", "name"])?;
        let name = required(attributes, "filename")?;
        let told = |error: String| format!("file {} {error}", quoted(name));
        let path = self.files.find(&source.folders, name).map_err(told)?;
        if self.open.contains(&path) {
            return Err(told("includes itself".to_owned()));
        }
        if self.open.len() > MOST_INCLUDED {
            return Err(format!(
                "includes are nested more than {MOST_INCLUDED} deep"
            ));
        }
        self.includes += 1;
        if self.includes > MAX_INCLUDES {
            // Only the first file beyond the limit adds a cause of refusal.
            return match self.includes == MAX_INCLUDES + 1 {
                true => Err(format!("more than {MAX_INCLUDES} files are included")),
                false => Ok(()),
            };
        }
        let text = self.files.read_text(&path).map_err(told)?;
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        let folders = std::iter::once(folder).chain(source.folders.iter().cloned());
        self.open.push(path);
        self.file(&text, name, folders.collect(), Some((parent, depth + 1)));
        self.open.pop();
        Ok(())
    }
}
