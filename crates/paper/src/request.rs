//! A request for figures.

use crate::quality::Quality;
use etendue_pipeline::load::SceneSource;
use etendue_store::ArgumentStyle;
use std::path::{Path, PathBuf};

/// A figure of the paper, or a scene of the user's own figure.
#[derive(Clone, Debug)]
pub enum Wanted {
    /// A figure of the paper (1, 3 to 17, or table1), or all figures of the paper.
    PaperFigure(String),
    /// A scene of the user; all requested scenes make one figure.
    Scene(SceneSource),
}

impl Wanted {
    /// Interprets a word: the name of a scene file ends in `.ron` or `.json`.
    #[must_use]
    pub fn named(word: &str, set: &[(String, String)], arguments: ArgumentStyle) -> Self {
        let path = Path::new(word);
        if path
            .extension()
            .is_some_and(|end| end == "ron" || end == "json")
        {
            Self::Scene(SceneSource {
                arguments,
                ..SceneSource::file(path, set)
            })
        } else {
            Self::PaperFigure(word.to_owned())
        }
    }
}

/// A request for figures.
#[derive(Clone, Debug)]
pub struct FigureRequest {
    /// Figures of the paper, or scenes, which make one figure.
    pub wanted: Vec<Wanted>,
    /// Fields of the scenes that were set to values. The command in `figure.json` repeats these
    /// settings; the scenes already have the values.
    pub set: Vec<(String, String)>,
    /// The plane at which scenes are shown. By default, several scenes are shown at their last
    /// planes, and a single scene is shown at all planes.
    pub plane: Option<String>,
    /// A file with the style of figures.
    pub style: Option<PathBuf>,
    /// The amount of work for the figures.
    pub quality: Quality,
    /// The folder of all figures.
    pub out: PathBuf,
    /// Whether files that Étendue did not write may be replaced.
    pub force: bool,
    /// The style in which messages name arguments.
    pub arguments: ArgumentStyle,
}
