//! What figures are asked for.

use crate::quality::Quality;
use std::path::PathBuf;

/// What is asked for.
#[derive(Clone, Debug)]
pub struct Request {
    /// Figures of the paper (1, 3 to 15, table1, or all), or scene files, which make one figure.
    pub names: Vec<String>,
    /// Fields of the scene files set to values.
    pub set: Vec<(String, String)>,
    /// The plane at which scene files are shown.
    pub plane: Option<String>,
    /// A file that says how figures look.
    pub style: Option<PathBuf>,
    /// How much work goes into them.
    pub quality: Quality,
    /// The folder of all figures.
    pub out: PathBuf,
    /// Whether files that Étendue did not write are replaced.
    pub force: bool,
}
