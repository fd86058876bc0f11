//! The Monte Carlo error of a mean over a window, predicted and found.

use crate::arguments::{Arguments, wrong};
use crate::live::alive;
use crate::run::Run;
use etendue_store::{ArgumentStyle, Failure};
use etendue_studies::variance::{
    FREQUENCIES, MAX_COUNTS, MAX_POINTS, PointCounts, PointFile, SETS, Sampler, VarianceOptions,
    VarianceStudy, point_file, table,
};
use numpy::PyReadonlyArray2;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use std::path::PathBuf;
use std::sync::Arc;

/// Predicts and finds the variances of samplers at a plane. Returns the index of the results in
/// JSON, and the tables for a terminal.
#[pyfunction]
pub(crate) fn variance(
    py: Python<'_>,
    run: &Run,
    arguments: &Bound<'_, PyDict>,
    threads: Option<usize>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<(String, String)> {
    let run = Arc::clone(&run.0);
    let arguments = Arguments(arguments);
    let options = options(&arguments, VarianceOptions::new(ArgumentStyle::Python))?;
    let mut plane = None;
    arguments.text("plane", &mut plane)?;
    alive(py, threads, progress.as_ref(), move |live| {
        let study = VarianceStudy::of_scene(&run.scene, (plane.as_deref(), run.method), options)?;
        study.check_memory()?;
        let found = study.run(live)?.ok_or_else(|| study.constant())?;
        let index = serde_json::to_string(&study.index((&run.scene, run.method), &found));
        let index = index.map_err(Failure::cannot_run)?;
        Ok((index, table::text(&found, &study.options)))
    })
}

fn options(
    arguments: &Arguments<'_, '_>,
    mut options: VarianceOptions,
) -> PyResult<VarianceOptions> {
    let [first, last] = [FREQUENCIES.start(), FREQUENCIES.end()].map(|m| *m as u64);
    arguments.whole("frequencies", &(first..=last), &mut options.frequencies)?;
    let [first, last] = [SETS.start(), SETS.end()].map(|n| u64::from(*n));
    arguments.whole("shifts", &(first..=last), &mut options.shifts)?;
    arguments.flag("unshifted", &mut options.unshifted)?;
    arguments.flag("light_points", &mut options.light_points)?;
    if let Some(value) = arguments.get("counts")? {
        options.counts = counts(&value)?;
    }
    if let Some(value) = arguments.get("samplers")? {
        options.samplers = samplers("samplers", &value)?;
    }
    Ok(options)
}

/// Reads numbers of points, from text such as 4..4096 or from whole numbers.
fn counts(value: &Bound<'_, PyAny>) -> PyResult<PointCounts> {
    let counts = match value.extract::<String>() {
        Ok(text) => text.parse().ok(),
        Err(_) => {
            let one = value.extract().map(|count: usize| vec![count]);
            one.or_else(|_| value.extract())
                .ok()
                .and_then(PointCounts::new)
        }
    };
    let allowed = format!(
        "a whole number, text such as '4..4096', or a sequence of 1 to {MAX_COUNTS} whole numbers from 2 to {MAX_POINTS}"
    );
    counts.ok_or_else(|| wrong("counts", value, allowed))
}

/// Reads samplers: names, arrays of points, and paths of files of points.
pub(crate) fn samplers(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<Sampler>> {
    let allowed = "a sequence of names, arrays of points and paths, such as ['sobol', 'set.npy']";
    let is_text = value.is_instance_of::<PyString>();
    let items = value.try_iter().ok().filter(|_| !is_text);
    let items = items.ok_or_else(|| wrong(argument, value, allowed))?;
    let mut all = Vec::new();
    for (i, item) in items.enumerate() {
        all.extend(sampler(argument, i, &item?)?);
    }
    let names: Vec<String> = all.iter().map(Sampler::to_string).collect();
    if names.is_empty() {
        return Err(wrong(argument, value, allowed));
    }
    match (1..names.len()).find(|i| names[..*i].contains(&names[*i])) {
        Some(i) => Err(PyValueError::new_err(format!(
            "{argument} has {:?} twice; allowed: each sampler once",
            names[i]
        ))),
        None => Ok(all),
    }
}

/// Reads the element with this number.
fn sampler(argument: &str, number: usize, item: &Bound<'_, PyAny>) -> PyResult<Vec<Sampler>> {
    let name = format!("{argument}[{number}]");
    if let Ok(points) = item.extract::<PyReadonlyArray2<'_, f64>>() {
        let array = points.as_array();
        let rows = array.outer_iter().map(|row| row.iter().copied().collect());
        let rows: Vec<Vec<f64>> = rows.collect();
        let points = rows.iter().map(|row| row.as_slice().try_into().ok());
        let points: Option<Vec<[f64; 4]>> = points.collect();
        let points = points.ok_or_else(|| {
            let [n, columns] = [array.nrows(), array.ncols()];
            PyValueError::new_err(format!(
                "{name} has the shape ({n}, {columns}); allowed: (N, 4), with the axes x, u, y, v"
            ))
        })?;
        let file = PointFile::new(format!("array {number}"), points);
        let file = file.map_err(|error| PyValueError::new_err(format!("{name}: {error}")))?;
        return Ok(vec![Sampler::File(file)]);
    }
    let named = item.extract::<String>().ok();
    if let Some(samplers) = named.as_deref().and_then(Sampler::named) {
        return Ok(samplers);
    }
    let path: Option<PathBuf> = item.extract().ok();
    let is_file = |path: &PathBuf| named.is_none() || path.extension().is_some_and(|e| e == "npy");
    let path = path.filter(is_file).ok_or_else(|| {
        let allowed = format!(
            "{}, an array of float64 [N, 4], or a path of an NPY file that ends with .npy",
            Sampler::NAMES.join(", ")
        );
        match array_kind(item) {
            Ok(kind) => PyValueError::new_err(format!("{name} is {kind}; allowed: {allowed}")),
            Err(_) => wrong(&name, item, allowed),
        }
    })?;
    let file = point_file::read(&path, ArgumentStyle::Python);
    let file = file.map_err(|failure| crate::raised::raised(item.py(), failure))?;
    Ok(vec![Sampler::File(file)])
}

/// Returns the type of the numbers and the shape of an array, in words.
fn array_kind(item: &Bound<'_, PyAny>) -> PyResult<String> {
    let [numbers, shape] = [item.getattr("dtype")?.str()?, item.getattr("shape")?.str()?];
    Ok(format!("an array of {numbers} with the shape {shape}"))
}
