//! Scenes of other programs as Python arguments.

use crate::arguments::Arguments;
use etendue_import::Color;
use etendue_store::ArgumentStyle;
use etendue_view::ranges::{MAX_ANGLE, MAX_COORDINATE, SIDE, SKY};
use etendue_view::{CameraChoice, Viewpoint, WorldSource};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::path::PathBuf;

/// Returns the scene of a file, modified by the arguments.
pub(crate) fn source(path: PathBuf, arguments: &Arguments<'_, '_>) -> PyResult<WorldSource> {
    let mut source = WorldSource::new(path, ArgumentStyle::Python);
    arguments.path("root", &mut source.options.root)?;
    arguments.one_of("color", &Color::ALL, &mut source.options.color)?;
    if let Some(set) = arguments.get("set")? {
        source.options.set = set.extract()?;
    }
    source.bounces = arguments.given("bounces", &(0..=u32::MAX.into()))?;
    if arguments.get("sky")?.is_some() {
        let mut radiance = 0.0;
        let allowed = format!("a number from {} to {:e}", SKY.start(), SKY.end());
        arguments.number("sky", &allowed, |x| SKY.contains(x), &mut radiance)?;
        source.sky = Some(radiance);
    }
    source.viewpoint = viewpoint(arguments)?;
    Ok(source)
}

/// Returns the camera that the arguments add to the scene, if any.
fn viewpoint(arguments: &Arguments<'_, '_>) -> PyResult<Option<Viewpoint>> {
    let point = |name| arguments.point(name, MAX_COORDINATE);
    let up = point("up")?;
    let is_angle = |fov: &f64| 0.0 < *fov && *fov < MAX_ANGLE;
    let mut fov = Viewpoint::FOV;
    let allowed = format!("above 0 and below {MAX_ANGLE}");
    arguments.number("fov", &allowed, is_angle, &mut fov)?;
    let fault = |message: &str| Err(PyValueError::new_err(message.to_owned()));
    match (point("look_from")?, point("look_at")?) {
        (Some(from), Some(at)) => Ok(Some(Viewpoint {
            from: from.into(),
            at: at.into(),
            up: up.map_or(Viewpoint::UP, Into::into),
            fov,
        })),
        (None, None) if up.is_none() && arguments.get("fov")?.is_none() => Ok(None),
        (None, None) => fault(
            "up and fov are allowed only together with look_from and look_at, which add a camera",
        ),
        _ => fault("look_from and look_at must be given together"),
    }
}

/// Returns the selected camera.
pub(crate) fn camera(arguments: &Arguments<'_, '_>) -> PyResult<CameraChoice> {
    let mut choice = CameraChoice::default();
    arguments.text("camera", &mut choice.name)?;
    arguments.size("size", &SIDE, &mut choice.size)?;
    Ok(choice)
}
