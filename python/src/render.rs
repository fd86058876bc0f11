//! Pictures of scenes of other programs.

use crate::arguments::Arguments;
use crate::live::alive;
use crate::world;
use etendue_view::{PictureRequest, ranges};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// Renders the picture of a camera into a folder.
#[pyfunction]
pub(crate) fn render(
    py: Python<'_>,
    scene: PathBuf,
    out: PathBuf,
    arguments: &Bound<'_, PyDict>,
    threads: Option<usize>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<()> {
    let request = request(scene, &Arguments(arguments))?;
    alive(py, threads, progress.as_ref(), move |live| {
        etendue_view::render(&request, &out, live).map(drop)
    })
}

fn request(scene: PathBuf, arguments: &Arguments<'_, '_>) -> PyResult<PictureRequest> {
    let mut request = PictureRequest::new(world::source(scene, arguments)?);
    request.camera = world::camera(arguments)?;
    arguments.whole("samples", &ranges::SAMPLES, &mut request.samples)?;
    request.shading_samples = arguments.given("shading_samples", &ranges::SHADING_SAMPLES)?;
    request.method = PictureRequest::usual_method(request.shading_samples);
    arguments.one_of("method", &PictureRequest::METHODS, &mut request.method)?;
    arguments.whole("paths", &ranges::PATHS, &mut request.paths)?;
    request.blocker_rays = arguments.given("blocker_rays", &ranges::BLOCKER_RAYS)?;
    arguments.flag("isotropic", &mut request.isotropic)?;
    arguments.whole("seed", &(0..=u64::MAX), &mut request.seed)?;
    arguments.flag("force", &mut request.force)?;
    Ok(request)
}
