//! Scenes of other programs, as they are read for pictures and probes.

use etendue_import::{Imported, Options, import};
use etendue_store::{ArgumentStyle, Failure};
use etendue_world::{Camera, Light, Projection, World};
use glam::{DAffine3, DMat3, DVec3};
use std::path::PathBuf;

/// A scene file of another program, and what is changed in it.
#[derive(Clone, Debug)]
pub struct WorldSource {
    /// Mitsuba 3, pbrt-v4, glTF 2.0, OBJ or PLY.
    pub path: PathBuf,
    /// How it is read.
    pub options: Options,
    /// Most surfaces that light meets between a source and the camera, instead of the file's.
    pub bounces: Option<u32>,
    /// Radiance that comes from everywhere, W/(m² sr).
    pub sky: Option<f64>,
    /// A camera that the scene need not have: the first, named `command`.
    pub viewpoint: Option<Viewpoint>,
    /// How messages name arguments.
    pub arguments: ArgumentStyle,
}

/// Where a camera of 512 × 512 pixels stands, and where it looks, in coordinates of the scene.
#[derive(Clone, Copy, Debug)]
pub struct Viewpoint {
    /// Its place.
    pub from: DVec3,
    /// What is in the middle of its picture.
    pub at: DVec3,
    /// What is up in its picture.
    pub up: DVec3,
    /// Its angle from side to side, degrees.
    pub fov: f64,
}

/// Which camera looks.
#[derive(Clone, Debug, Default)]
pub struct CameraChoice {
    /// Its name; otherwise the first.
    pub name: Option<String>,
    /// Pixels across and down, instead of the camera's.
    pub size: Option<[usize; 2]>,
}

impl WorldSource {
    /// A scene file as it is.
    #[must_use]
    pub fn new(path: PathBuf, arguments: ArgumentStyle) -> Self {
        Self {
            path,
            options: Options::default(),
            bounces: None,
            sky: None,
            viewpoint: None,
            arguments,
        }
    }
}

impl Viewpoint {
    /// What is up, unless said.
    pub const UP: DVec3 = DVec3::Y;
    /// The angle from side to side, unless said, degrees.
    pub const FOV: f64 = 45.0;
}

/// Says how a scene comes to a camera.
pub(crate) fn no_camera(arguments: ArgumentStyle) -> String {
    let [from, at] = ["look_from", "look_at"].map(|name| arguments.name(name));
    format!("the scene has no camera: {from} and {at} add one")
}

/// Says how a scene comes to a light.
pub(crate) fn no_light(arguments: ArgumentStyle) -> String {
    format!("the scene has no light: {} adds one", arguments.name("sky"))
}

/// Reads a scene; causes for which it is refused come all together.
pub(crate) fn load(source: &WorldSource) -> Result<Imported, Failure> {
    let mut imported = import(&source.path, &source.options).map_err(Failure::bad_input)?;
    if source.bounces.is_some() {
        imported.world.depth = source.bounces;
    }
    if let Some(radiance) = source.sky {
        imported.world.lights.push(Light::Constant { radiance });
    }
    if let Some(viewpoint) = &source.viewpoint {
        imported
            .world
            .cameras
            .insert(0, camera_at(viewpoint, source.arguments)?);
    }
    Ok(imported)
}

/// What was left out of the scene or approximated, for result files and the terminal.
pub(crate) fn notes(imported: &Imported) -> Vec<String> {
    imported.notes.iter().map(ToString::to_string).collect()
}

/// The camera that a viewpoint puts into the scene.
fn camera_at(viewpoint: &Viewpoint, arguments: ArgumentStyle) -> Result<Camera, Failure> {
    let ahead = (viewpoint.at - viewpoint.from).try_normalize();
    let frame = ahead.and_then(|ahead| {
        let left = viewpoint.up.cross(ahead).try_normalize()?;
        Some(DMat3::from_cols(left, ahead.cross(left), ahead))
    });
    let frame = frame.ok_or_else(|| {
        let [from, at, up] = ["look_from", "look_at", "up"].map(|name| arguments.name(name));
        Failure::bad_input(format!(
            "{from} and {at} are one place, or {up} goes along the line between them"
        ))
    })?;
    Ok(Camera {
        name: "command".to_owned(),
        to_world: DAffine3::from_mat3_translation(frame, viewpoint.from),
        size: [512; 2],
        projection: Projection::Perspective {
            half_width: libm::tan(viewpoint.fov.to_radians() / 2.0),
            shift: [0.0; 2],
            lens: None,
        },
        clip: [0.0, f64::MAX],
    })
}

/// Whether something shines.
pub(crate) fn has_light(world: &World) -> bool {
    let shines = world.shapes.iter().any(|shape| shape.emission.is_some());
    shines || !world.lights.is_empty()
}

/// Requires something that shines.
pub(crate) fn require_light(world: &World, arguments: ArgumentStyle) -> Result<(), Failure> {
    if has_light(world) {
        return Ok(());
    }
    Err(Failure::bad_input(no_light(arguments)))
}

/// The camera that is asked for, or the first, with the size that is asked for.
pub(crate) fn camera(
    world: &World,
    choice: &CameraChoice,
    arguments: ArgumentStyle,
) -> Result<Camera, Failure> {
    let is_meant = |camera: &&Camera| choice.name.as_ref().is_none_or(|name| *name == camera.name);
    let camera = world.cameras.iter().find(is_meant).ok_or_else(|| {
        let names: Vec<&str> = world
            .cameras
            .iter()
            .map(|camera| camera.name.as_str())
            .collect();
        Failure::bad_input(match &choice.name {
            Some(name) if !names.is_empty() => {
                let camera = arguments.with("camera", name);
                format!("{camera}; allowed: {}", names.join(", "))
            }
            _ => no_camera(arguments),
        })
    })?;
    Ok(Camera {
        size: choice.size.unwrap_or(camera.size),
        ..camera.clone()
    })
}
