//! The content of a scene of another program.

use crate::arguments::Arguments;
use crate::live::alive;
use crate::world;
use etendue_view::Contents;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// Reads a scene; returns a dictionary of its content.
#[pyfunction]
pub(crate) fn import_scene<'py>(
    py: Python<'py>,
    scene: PathBuf,
    arguments: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyDict>> {
    let source = world::source(scene, &Arguments(arguments))?;
    let contents = alive(py, None, None, move |_| Contents::read(&source))?;
    let found = PyDict::new(py);
    let cameras = contents.cameras.iter();
    let cameras = cameras.map(|camera| (camera.name.clone(), camera.size));
    found.set_item("cameras", cameras.collect::<Vec<_>>())?;
    let counts = PyDict::new(py);
    for (kind, count) in &contents.counts {
        counts.set_item(kind, count)?;
    }
    found.set_item("counts", counts)?;
    found.set_item("depth", contents.depth)?;
    found.set_item("has_light", contents.has_light)?;
    found.set_item("lines", contents.lines())?;
    found.set_item("notes", contents.notes)?;
    Ok(found)
}
