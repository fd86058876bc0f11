//! The main file of a scene, with the files that it may name.

use crate::files::Files;
use crate::report::SourcePlace;
use crate::{Options, Refused};
use std::io;
use std::path::{Path, PathBuf};

/// The main file of a scene.
#[derive(Debug)]
pub(crate) struct MainFile<'a> {
    /// The files that it may name.
    pub(crate) files: Files,
    /// Its path, links followed.
    pub(crate) path: PathBuf,
    /// Its name in messages.
    pub(crate) name: String,
    /// The path that the user gave.
    given: &'a Path,
}

impl<'a> MainFile<'a> {
    /// The file at a path. The user names it, so it need not be below the root.
    pub(crate) fn open(path: &'a Path, options: &Options) -> Result<Self, Refused> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        Self::new(path, folder, &name, options)
    }

    /// A text that stands for the file of this name in `folder`.
    pub(crate) fn of_text(
        folder: &'a Path,
        name: &str,
        options: &Options,
    ) -> Result<Self, Refused> {
        let mut file = Self::new(folder, folder, "text", options)?;
        file.path.push(name);
        Ok(file)
    }

    fn new(given: &'a Path, folder: &Path, name: &str, options: &Options) -> Result<Self, Refused> {
        let unread = |error: io::Error| Refused::because(given, error.to_string());
        let root = options.root.as_deref().unwrap_or(folder);
        Ok(Self {
            files: Files::below(root).map_err(unread)?,
            path: given.canonicalize().map_err(unread)?,
            name: name.to_owned(),
            given,
        })
    }

    /// Its bytes.
    pub(crate) fn read(&self) -> Result<Vec<u8>, Refused> {
        let bytes = self.files.read(&self.path);
        bytes.map_err(|error| self.refused(error))
    }

    /// The folder in which it lies.
    pub(crate) fn folder(&self) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).to_owned()
    }

    /// The file as a whole.
    pub(crate) fn place(&self) -> SourcePlace {
        SourcePlace::whole(&self.name)
    }

    /// Refuses the scene for one cause.
    pub(crate) fn refused(&self, message: impl Into<String>) -> Refused {
        Refused::because(self.given, message)
    }
}
