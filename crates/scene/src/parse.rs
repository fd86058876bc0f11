//! Reads scene files.

use crate::shown::shown;
use crate::{SceneError, SceneFile, limits};

impl SceneFile {
    /// Reads a scene file.
    ///
    /// # Errors
    /// [`SceneError::Syntax`] with line, column and what is allowed there.
    pub fn parse(text: &str) -> Result<Self, SceneError> {
        // Some editors begin a file with a byte order mark.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        ron::Options::default()
            .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
            .from_str(text)
            .map_err(|error| SceneError::Syntax {
                line: error.span.start.line,
                column: error.span.start.col,
                message: shown(error.code, limits::ALLOWED),
            })
    }
}
