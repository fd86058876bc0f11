//! Fits of scene fields to a measurement.

use crate::live::alive;
use crate::outcome::Measurement;
use crate::scene::SceneArgument;
use etendue_studies::fit::{FitData, FitRequest, index};
use pyo3::prelude::*;
use std::path::PathBuf;

/// What a scene is fitted to.
#[derive(FromPyObject)]
pub(crate) enum Target<'py> {
    /// A measurement in memory.
    Measurement(PyRef<'py, Measurement>),
    /// Folders of a measurement, or a file of arrays.
    Paths(Vec<PathBuf>),
}

/// Fits free fields of a scene. Returns the content of `fit.json`.
#[pyfunction]
#[expect(
    clippy::too_many_arguments,
    reason = "the arguments of a function of Python"
)]
pub(crate) fn fit(
    py: Python<'_>,
    scene: SceneArgument,
    set: Vec<(String, String)>,
    to: Target<'_>,
    free: Vec<String>,
    ranges: Vec<(String, [f64; 2])>,
    starts: usize,
    planes: Vec<String>,
    threads: Option<usize>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<String> {
    let request = FitRequest {
        scene: scene.source(&set)?,
        free,
        ranges,
        starts,
        planes,
    };
    let (measurement, paths) = match to {
        Target::Measurement(measurement) => (Some(measurement.0.clone()), Vec::new()),
        Target::Paths(paths) => (None, paths),
    };
    alive(py, threads, progress.as_ref(), move |live| {
        let (scene, starts) = request.read()?;
        let data = match measurement {
            Some(measurement) => FitData::of_measurement(&measurement, &scene)?,
            None => FitData::read(&paths, &scene)?,
        };
        let data = data.at(&request.planes, request.scene.arguments)?;
        let fitted = request.run(&scene, &starts, &data, live)?;
        Ok(index(&scene, &fitted).to_string())
    })
}
