//! A figure to be made, and the data from which it is drawn.

use crate::quality::Quality;
use crate::scene_run::Shot;
use etendue_figures::{AxisQuantity, CurvePanel, Curves, Figure, Plate, Style, curves, plate};
use etendue_pipeline::Reporter;
use etendue_report::pictures;
use etendue_scene::Scene;
use etendue_store::Failure;
use std::path::PathBuf;

/// Name and text of a scene file.
pub(crate) type Text = (&'static str, &'static str);

/// The definition of a figure.
#[derive(Debug)]
pub struct Subject {
    /// Name of the figure's folder within the folder of all figures.
    pub(crate) name: String,
    pub(crate) about: String,
    /// Arguments of `etendue figure` that make the figure again.
    pub(crate) arguments: String,
    /// The scenes to run, at their own frequencies.
    pub(crate) scenes: Vec<Scene>,
    /// Whether these are the user's scenes, which are stored in the index.
    pub(crate) is_own: bool,
    /// Name and text of each scene file of the repository that is stored with the figure.
    pub(crate) texts: Vec<Text>,
    /// Input files, which must not be replaced.
    pub(crate) inputs: Vec<PathBuf>,
    /// Warnings about the scenes.
    pub(crate) warnings: Vec<String>,
    /// Whether the figure shows full radial spectra.
    pub(crate) full_radial: bool,
    /// Other scene files, from which curves are computed or measured.
    pub(crate) also: &'static [Text],
    /// The plane at which each scene is shown; empty if all planes are shown.
    pub(crate) planes: Vec<String>,
    pub(crate) draw: fn(&FigureData<'_>) -> Result<Figure, Failure>,
}

impl Subject {
    /// Name of the figure's folder within the folder of all figures.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Warnings about the scenes.
    #[must_use]
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }
}

/// The data from which a figure is drawn.
pub(crate) struct FigureData<'a> {
    /// The results of the scenes that were run.
    pub(crate) shots: &'a [Shot],
    /// The other scene files.
    pub(crate) also: &'static [Text],
    /// The plane at which each scene is shown; empty if all planes are shown.
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

    /// Draws curves of a quantity, with a title and a note.
    pub(crate) fn curves(
        &self,
        words: [&str; 2],
        y: AxisQuantity,
        panels: Vec<CurvePanel>,
    ) -> Result<Figure, Failure> {
        let [title, note] = words.map(str::to_owned);
        let of = Curves {
            title,
            note,
            y,
            panels,
        };
        curves(&of, &self.style).map_err(Failure::cannot_run)
    }

    /// Draws the planes of the first scene along its path, measured and predicted. The figure has
    /// no table, because arrays store cells more compactly.
    pub(crate) fn strip(&self) -> Result<Figure, Failure> {
        let Shot {
            scene,
            photons,
            theories,
            planes,
        } = &self.shots[0];
        let strip = pictures::strip_of(scene, *photons, theories, planes, Some(&self.style))?;
        Ok(Figure {
            csv: String::new(),
            ..strip
        })
    }
}
