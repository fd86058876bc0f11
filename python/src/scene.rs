//! Scenes as Python arguments.

use etendue_pipeline::load::SceneSource;
use etendue_store::ArgumentStyle;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::path::{Path, PathBuf};

/// The path of a scene file, or the text of a scene.
#[derive(FromPyObject)]
pub(crate) enum SceneArgument {
    /// Text in RON or JSON, the name of the scene, and the folder of its meshes and pictures.
    Text((String, String, PathBuf)),
    /// The path of a file.
    File(PathBuf),
}

impl SceneArgument {
    /// Returns the scene with some of its fields replaced.
    pub(crate) fn source(self, set: &[(String, String)]) -> PyResult<SceneSource> {
        let (path, text) = match self {
            Self::File(path) => (path, None),
            Self::Text((text, name, folder)) => {
                let file = format!("{name}.ron");
                if Path::new(&file)
                    .file_name()
                    .is_none_or(|whole| whole != file.as_str())
                {
                    let message =
                        format!("name is {name:?}; allowed: a file name without a folder");
                    return Err(PyValueError::new_err(message));
                }
                (folder.join(file), Some(text))
            }
        };
        Ok(SceneSource {
            path,
            text,
            set: set.to_owned(),
            color: None,
            arguments: ArgumentStyle::Python,
        })
    }
}
