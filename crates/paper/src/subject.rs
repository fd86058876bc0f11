//! A figure to be made, and what it is drawn from.

use crate::quality::Quality;
use crate::scene_run::Shot;
use etendue_figures::{Curves, Figure, Plate, Style, curves, plate};
use etendue_pipeline::Reporter;
use etendue_report::pictures;
use etendue_scene::Scene;
use etendue_store::Failure;
use std::path::PathBuf;

/// Name and text of a scene file.
pub(crate) type Text = (&'static str, &'static str);

/// What a figure is made of.
#[derive(Debug)]
pub struct Subject {
    /// Its folder below that of all figures.
    pub(crate) name: String,
    pub(crate) about: String,
    /// What stands behind `etendue figure` to make it again.
    pub(crate) arguments: String,
    /// The scenes that are run, at their own frequencies.
    pub(crate) scenes: Vec<Scene>,
    /// Whether these are the user's: then the index holds them.
    pub(crate) is_own: bool,
    /// Name and text of scene files of the repository, which are kept with it.
    pub(crate) texts: Vec<Text>,
    /// Files that must not be replaced.
    pub(crate) inputs: Vec<PathBuf>,
    /// What the user should know of the scenes.
    pub(crate) warnings: Vec<String>,
    /// Whether it shows curves or bars, which are kept as a table.
    pub(crate) has_table: bool,
    /// Whether it shows full radial spectra.
    pub(crate) full_radial: bool,
    /// Other scene files, from which curves are computed or measured.
    pub(crate) also: &'static [Text],
    /// The plane of each scene that is shown, where not all are.
    pub(crate) planes: Vec<String>,
    pub(crate) draw: fn(&FigureData<'_>) -> Result<Figure, Failure>,
}

impl Subject {
    /// Its folder below that of all figures.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What the user should know of the scenes.
    #[must_use]
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }
}

/// What a figure is drawn from.
pub(crate) struct FigureData<'a> {
    /// Its scenes, run.
    pub(crate) shots: &'a [Shot],
    /// The other scene files.
    pub(crate) also: &'static [Text],
    /// The plane of each scene that is shown, where not all are.
    pub(crate) planes: &'a [String],
    pub(crate) quality: Quality,
    pub(crate) style: Style,
    pub(crate) reporter: &'a dyn Reporter,
}

impl FigureData<'_> {
    /// Draws pictures in rows and columns.
    pub(crate) fn plate(&self, of: &Plate<'_>) -> Result<Figure, Failure> {
        plate(of, &self.style).map_err(Failure::cannot_run)
    }

    /// Draws curves.
    pub(crate) fn curves(&self, of: &Curves) -> Result<Figure, Failure> {
        curves(of, &self.style).map_err(Failure::cannot_run)
    }

    /// The planes of the first scene along its path, measured and predicted.
    pub(crate) fn strip(&self) -> Result<Figure, Failure> {
        let Shot {
            scene,
            photons,
            theories,
            planes,
        } = &self.shots[0];
        pictures::strip_of(scene, *photons, theories, planes, Some(&self.style))
    }
}
