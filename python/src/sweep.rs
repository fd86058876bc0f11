//! Sweeps of scene fields over several values.

use crate::arguments::Arguments;
use crate::live::alive;
use crate::scene::SceneArgument;
use etendue_store::{ArgumentStyle, Method};
use etendue_studies::sweep::values::{Setting, Sweep, setting_of};
use etendue_studies::sweep::{SweepPoints, SweepRequest, run};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// The value of a field.
#[derive(FromPyObject)]
pub(crate) enum Values {
    /// A value, a range or a list, as text.
    Text(String),
    /// Several numbers.
    Numbers(Vec<f64>),
}

fn setting((path, values): (String, Values)) -> PyResult<Setting> {
    let setting = match values {
        Values::Numbers(values) => Sweep::new(path, values).map(Setting::Sweep),
        Values::Text(text) => {
            let setting = setting_of(&path, &text, ArgumentStyle::Python);
            setting.map_err(|why| format!("in set, {path}: {why}"))
        }
    };
    setting.map_err(PyValueError::new_err)
}

/// Runs a sweep, and writes its table and its points to a folder.
#[pyfunction]
pub(crate) fn sweep(
    py: Python<'_>,
    scene: SceneArgument,
    set: Vec<(String, Values)>,
    out: PathBuf,
    arguments: &Bound<'_, PyDict>,
    threads: Option<usize>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<()> {
    let set: Vec<Setting> = set.into_iter().map(setting).collect::<PyResult<_>>()?;
    let mut request = SweepRequest::new(scene.source(&[])?, set);
    let arguments = Arguments(arguments);
    arguments.flag("together", &mut request.together)?;
    arguments.flag("common_seed", &mut request.common_seed)?;
    arguments.flag("force", &mut request.force)?;
    let methods = [Method::Photons, Method::Backward].map(|method| (method.name(), method));
    arguments.one_of("method", &methods, &mut request.method)?;
    let any = 0..=u64::MAX;
    if arguments.get("photons")?.is_some() {
        let mut photons = 0;
        arguments.count("photons", &(1..=u64::MAX), &mut photons)?;
        request.photons = Some(photons);
    }
    if arguments.get("seed")?.is_some() {
        let mut seed = 0;
        arguments.whole("seed", &any, &mut seed)?;
        request.seed = Some(seed);
    }
    alive(py, threads, progress.as_ref(), move |live| {
        let points = SweepPoints::read(&request)?;
        run(&request, &points, &out, None, live).map(drop)
    })
}
