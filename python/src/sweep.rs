//! Sweeps of scene fields over several values.

use crate::arguments::Arguments;
use crate::live::alive;
use crate::scene::SceneArgument;
use etendue_report::table::word;
use etendue_store::{ArgumentStyle, Method};
use etendue_studies::derivative::{DerivedField, derivative as of_field};
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

/// The sweep that Python asks for.
fn request(
    scene: SceneArgument,
    set: Vec<(String, Values)>,
    arguments: &Bound<'_, PyDict>,
) -> PyResult<SweepRequest> {
    let set: Vec<Setting> = set.into_iter().map(setting).collect::<PyResult<_>>()?;
    let mut request = SweepRequest::new(scene.source(&[])?, set);
    let arguments = Arguments(arguments);
    arguments.flag("together", &mut request.together)?;
    arguments.flag("common_seed", &mut request.common_seed)?;
    arguments.flag("force", &mut request.force)?;
    let methods = [Method::Photons, Method::Backward].map(|method| (method.name(), method));
    arguments.one_of("method", &methods, &mut request.method)?;
    if arguments.get("photons")?.is_some() {
        let mut photons = 0;
        arguments.count("photons", &(1..=u64::MAX), &mut photons)?;
        request.photons = Some(photons);
    }
    if arguments.get("seed")?.is_some() {
        let mut seed = 0;
        arguments.whole("seed", &(0..=u64::MAX), &mut seed)?;
        request.seed = Some(seed);
    }
    Ok(request)
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
    let request = request(scene, set, arguments)?;
    alive(py, threads, progress.as_ref(), move |live| {
        let points = SweepPoints::read(&request)?;
        run(&request, &points, &out, None, live).map(drop)
    })
}

/// Measures the derivative by a field, and writes its tables, arrays and points to a folder. Returns
/// the value of the field, the verdict, and the table for a terminal.
#[pyfunction]
#[expect(
    clippy::too_many_arguments,
    reason = "the arguments of a function of Python"
)]
pub(crate) fn derivative(
    py: Python<'_>,
    scene: SceneArgument,
    field: (String, Option<f64>),
    set: Vec<(String, Values)>,
    out: PathBuf,
    arguments: &Bound<'_, PyDict>,
    threads: Option<usize>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<(f64, String, String)> {
    let mut request = request(scene, set, arguments)?;
    let field = DerivedField::new(&field.0, field.1).map_err(|allowed| {
        PyValueError::new_err(format!(
            "step is {:?}; allowed: {allowed}",
            field.1.unwrap_or(f64::NAN)
        ))
    })?;
    alive(py, threads, progress.as_ref(), move |live| {
        let value = field.sweep(&mut request)?;
        let points = SweepPoints::read(&request)?;
        let found = of_field(&field, value, (&request, &points, &out), None, live)?;
        Ok((value, word(found.verdict).to_owned(), found.text()))
    })
}
