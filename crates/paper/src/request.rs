//! What figures are asked for.

use crate::quality::Quality;
use etendue_pipeline::load::SceneSource;
use etendue_store::ArgumentStyle;
use std::path::{Path, PathBuf};

/// A figure of the paper, or a scene of a figure of the user's own.
#[derive(Clone, Debug)]
pub enum Wanted {
    /// A figure of the paper (1, 3 to 17, or table1), or all of them.
    PaperFigure(String),
    /// A scene. All scenes make one figure.
    Scene(SceneSource),
}

impl Wanted {
    /// What a word means: the name of a scene file ends in `.ron` or `.json`.
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

/// What is asked for.
#[derive(Clone, Debug)]
pub struct FigureRequest {
    /// Figures of the paper, or scenes, which make one figure.
    pub wanted: Vec<Wanted>,
    /// Fields of the scenes set to values, for the command in `figure.json`: the scenes have them already.
    pub set: Vec<(String, String)>,
    /// The plane at which scenes are shown: otherwise the last of each of several scenes, and all of a single one.
    pub plane: Option<String>,
    /// A file that says how figures look.
    pub style: Option<PathBuf>,
    /// How much work goes into them.
    pub quality: Quality,
    /// The folder of all figures.
    pub out: PathBuf,
    /// Whether files that Étendue did not write are replaced.
    pub force: bool,
    /// How messages name arguments.
    pub arguments: ArgumentStyle,
}
