//! Draws figures of the paper, and figures of scenes.

use crate::arguments::Arguments;
use crate::live::alive;
use crate::scene::SceneArgument;
use etendue_paper::{FigureRequest, Quality, Wanted, make_all, subjects};
use etendue_store::{ArgumentStyle, Failure};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// Draws figures; returns the folder of the first figure.
#[pyfunction]
pub(crate) fn figure(
    py: Python<'_>,
    scenes: Vec<SceneArgument>,
    set: Vec<(String, String)>,
    out: PathBuf,
    arguments: &Bound<'_, PyDict>,
    threads: Option<usize>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<PathBuf> {
    let wanted = scenes.into_iter().map(|scene| match scene {
        SceneArgument::File(path) => {
            let word = path.to_string_lossy();
            Ok(Wanted::named(&word, &set, ArgumentStyle::Python))
        }
        text @ SceneArgument::Text(_) => text.source(&set).map(Wanted::Scene),
    });
    let mut request = FigureRequest {
        wanted: wanted.collect::<PyResult<_>>()?,
        set: set.clone(),
        plane: None,
        style: None,
        quality: Quality::default(),
        out: out.clone(),
        force: false,
        arguments: ArgumentStyle::Python,
    };
    let arguments = Arguments(arguments);
    arguments.text("plane", &mut request.plane)?;
    arguments.path("style", &mut request.style)?;
    arguments.flag("force", &mut request.force)?;
    let qualities = [Quality::Draft, Quality::Print].map(|quality| (quality.name(), quality));
    arguments.one_of("quality", &qualities, &mut request.quality)?;
    alive(py, threads, progress.as_ref(), move |live| {
        let subjects = subjects(&request)?;
        let first = subjects.first();
        let first = first.ok_or_else(|| {
            Failure::bad_input("a figure needs at least one scene, but no scene is given")
        })?;
        make_all(&request, &subjects, live)?;
        Ok(out.join(first.name()))
    })
}
