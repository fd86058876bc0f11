//! The main file of a scene, with options, the files it may refer to, and the report on all of
//! them.

use crate::files::Files;
use crate::report::{Report, SourcePlace};
use crate::{Color, Imported, Refused};
use etendue_world::World;
use std::io;
use std::path::{Path, PathBuf};

/// Options for reading a scene.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// The folder that must contain all files after links are followed; `None` stands for the scene
    /// file's own folder.
    pub root: Option<PathBuf>,
    /// The number of each colour; worlds are monochrome.
    ///
    /// Levels of 8-bit pictures are linearised first. The channels match the `rgb` variants of
    /// Mitsuba 3.9.
    ///
    /// A sampled spectrum becomes a colour as in Mitsuba. The spectrum is interpolated linearly at
    /// 1000 wavelengths from 360 to 830 nm, and is zero beyond its ends. The 1000 interpolated
    /// values are weighted with the CIE 1931 matching functions and converted to linear sRGB.
    /// Reflectances are also weighted with D65 and clamped to 0 to 1. Radiances and indices of
    /// refraction are clamped to at least 0. A spectrum that is given by one number becomes this
    /// number. For lights, each channel is multiplied by the same channel of the equal-energy
    /// white, (1.2048, 0.9483, 0.9089).
    pub color: Color,
    /// The memory that the files of a scene and their content may take, bytes; at most 4 GiB, which
    /// `None` stands for.
    pub memory: Option<u64>,
    /// Values of Mitsuba's `$parameters`, which override the values in the file.
    pub set: Vec<(String, String)>,
}

/// The main file of a scene.
#[derive(Debug)]
pub(crate) struct MainFile<'a> {
    /// The files that the scene may refer to.
    pub(crate) files: Files,
    /// The causes for refusal, and notes.
    pub(crate) report: Report,
    pub(crate) options: &'a Options,
    /// The path of the file, with links resolved.
    pub(crate) path: PathBuf,
    /// The name of the file in messages.
    pub(crate) name: String,
    /// The path of the file as the user gave it.
    given: &'a Path,
}

impl<'a> MainFile<'a> {
    /// Opens the file at a path. The user chose this file, so it need not be below the root.
    pub(crate) fn open(path: &'a Path, options: &'a Options) -> Result<Self, Refused> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        Self::new(path, folder, &name, options)
    }

    /// Creates a main file from a text, which replaces the file with the given name in `folder`.
    pub(crate) fn of_text(
        folder: &'a Path,
        name: &str,
        options: &'a Options,
    ) -> Result<Self, Refused> {
        let mut file = Self::new(folder, folder, "text", options)?;
        file.path.push(name);
        Ok(file)
    }

    fn new(
        given: &'a Path,
        folder: &Path,
        name: &str,
        options: &'a Options,
    ) -> Result<Self, Refused> {
        let unread = |error: io::Error| Refused::because(given, error.to_string());
        let root = options.root.as_deref().unwrap_or(folder);
        Ok(Self {
            files: Files::below(root, options.memory).map_err(unread)?,
            report: Report::default(),
            options,
            path: given.canonicalize().map_err(unread)?,
            name: name.to_owned(),
            given,
        })
    }

    /// Reads the bytes of the file.
    pub(crate) fn read(&self) -> Result<Vec<u8>, Refused> {
        let bytes = self.files.read(&self.path);
        bytes.map_err(|error| self.refused(error))
    }

    /// The folder that contains the file.
    pub(crate) fn folder(&self) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).to_owned()
    }

    /// The place of the file as a whole, for messages.
    pub(crate) fn place(&self) -> SourcePlace {
        SourcePlace::whole(&self.name)
    }

    /// The world, or all causes for refusal.
    pub(crate) fn finish(self, world: World) -> Result<Imported, Refused> {
        self.report.finish(world, &self.files)
    }

    /// The refusal of a scene for a single cause.
    pub(crate) fn refused(&self, message: impl Into<String>) -> Refused {
        Refused {
            lacks_memory: self.files.lacks_memory(),
            ..Refused::because(self.given, message)
        }
    }
}
