//! Probes the light field behind a pixel, in a scene of another program.

use crate::arguments::{self, Arguments};
use crate::live::alive;
use crate::variance::samplers;
use crate::world;
use etendue_store::ArgumentStyle;
use etendue_studies::variance::VarianceOptions;
use etendue_view::{ProbeRequest, probe_pixel, ranges};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// Measures the light field behind a pixel, and writes the results to a folder. Returns a report on
/// the results.
#[pyfunction]
pub(crate) fn probe(
    py: Python<'_>,
    scene: PathBuf,
    pixel: &Bound<'_, PyAny>,
    out: PathBuf,
    arguments: &Bound<'_, PyDict>,
    threads: Option<usize>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Vec<String>> {
    let pixel = arguments::pixel(pixel)?;
    let mut request = request(scene, &Arguments(arguments))?;
    request.out = Some(out);
    alive(py, threads, progress.as_ref(), move |live| {
        probe_pixel(&request, pixel, live).map(|found| found.lines)
    })
}

fn request(scene: PathBuf, arguments: &Arguments<'_, '_>) -> PyResult<ProbeRequest> {
    let mut request = ProbeRequest::new(world::source(scene, arguments)?);
    request.camera = world::camera(arguments)?;
    arguments.whole("depth", &ranges::SURFACES, &mut request.surfaces)?;
    let window = ranges::WINDOW;
    let allowed = format!(
        "a number of pixels from {} to {}",
        window.start(),
        window.end()
    );
    let mut across = f64::NAN;
    arguments.number("window", &allowed, |x| window.contains(x), &mut across)?;
    request.window = (!across.is_nan()).then_some(across);
    arguments.count("rays", &ranges::RAYS, &mut request.rays)?;
    let mut photons = 0;
    arguments.count("photons", &ranges::RAYS, &mut photons)?;
    request.photons = (photons > 0).then_some(photons);
    arguments.whole("seed", &(0..=u64::MAX), &mut request.seed)?;
    arguments.flag("covariance", &mut request.covariance)?;
    if let Some(value) = arguments.get("variance")? {
        let mut options = VarianceOptions::new(ArgumentStyle::Python);
        let asked = value.extract::<bool>().ok();
        if asked.is_none() {
            options.samplers = samplers("variance", &value)?;
        }
        request.variance = (asked != Some(false)).then_some(options);
    }
    arguments.flag("force", &mut request.force)?;
    Ok(request)
}
