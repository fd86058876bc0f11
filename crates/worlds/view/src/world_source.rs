//! Reads scenes of other programs, to render pictures and to probe light fields.

use etendue_import::{Imported, Options, import};
use etendue_paths::Paths;
use etendue_pipeline::{Progress, Reporter};
use etendue_store::sealed::json;
use etendue_store::{ArgumentStyle, Failure, Results, VERSION, machine};
use etendue_world::{Camera, Light, Material, World};
use glam::DVec3;
use serde_json::{Value, json as tree_of};
use std::path::PathBuf;

/// Another program's scene file, and the changes to it.
#[derive(Clone, Debug)]
pub struct WorldSource {
    /// A file in Mitsuba 3, pbrt-v4, glTF 2.0, OBJ or PLY format.
    pub path: PathBuf,
    /// Options of the importer.
    pub options: Options,
    /// The largest number of surfaces that light meets between a source and the camera; it replaces
    /// the number in the file.
    pub bounces: Option<u32>,
    /// Radiance of a uniform sky, W/(m² sr).
    pub sky: Option<f64>,
    /// A camera that is added to the scene as its first camera, with the name `command`.
    pub viewpoint: Option<Viewpoint>,
    /// How messages name arguments: as options of the command, or as keywords of Python.
    pub arguments: ArgumentStyle,
}

/// The position and direction of a camera of 512 × 512 pixels, in coordinates of the scene.
#[derive(Clone, Copy, Debug)]
pub struct Viewpoint {
    /// Position of the camera.
    pub from: DVec3,
    /// The point in the middle of the picture.
    pub at: DVec3,
    /// The up direction of the picture.
    pub up: DVec3,
    /// The horizontal angle of view, degrees.
    pub fov: f64,
}

/// The selected camera.
#[derive(Clone, Debug, Default)]
pub struct CameraChoice {
    /// Name of the camera; by default, the first camera is used.
    pub name: Option<String>,
    /// Number of pixels across and down, which replaces the number in the file.
    pub size: Option<[usize; 2]>,
}

impl WorldSource {
    /// A scene file without changes.
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
    /// Default up direction.
    pub const UP: DVec3 = DVec3::Y;
    /// Default horizontal angle of view, degrees.
    pub const FOV: f64 = 45.0;
}

/// A message on how to add a camera to a scene.
pub(crate) fn no_camera(arguments: ArgumentStyle) -> String {
    let [from, at] = ["look_from", "look_at"].map(|name| arguments.name(name));
    format!("the scene has no camera: {from} and {at} add one")
}

/// A message on how to add a light to a scene.
pub(crate) fn no_light(arguments: ArgumentStyle) -> String {
    format!("the scene has no light: {} adds one", arguments.name("sky"))
}

/// Reads a scene; all reasons for a refusal are reported together.
pub(crate) fn load(source: &WorldSource) -> Result<Imported, Failure> {
    let options = Options {
        memory: Some(machine::available_memory()),
        ..source.options.clone()
    };
    let mut imported = import(&source.path, &options).map_err(|refused| {
        if refused.lacks_memory {
            Failure::cannot_run(refused)
        } else {
            Failure::bad_input(refused)
        }
    })?;
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

/// Prepares a scene for rays, unless the hierarchies over it would not fit into memory.
pub(crate) fn paths(world: &World) -> Result<Paths, Failure> {
    let [needed, left] = [Paths::bytes(world), machine::available_memory() as f64];
    if needed > left {
        let [needed, left] = [needed, left].map(|bytes| format!("{:.2} GB", bytes / 1e9));
        return Err(Failure::cannot_run(format!(
            "rays through the scene need {needed} of memory for hierarchies; {left} are available"
        )));
    }
    Ok(Paths::new(world))
}

/// Returns notes on omissions and approximations of the scene, for result files and the terminal.
pub(crate) fn notes(imported: &Imported) -> Vec<String> {
    let notes = imported.notes.iter().map(ToString::to_string);
    notes.chain(lost_light(&imported.world)).collect()
}

/// The settings that every result depends on, for its index.
pub(crate) fn made_from(
    source: &WorldSource,
    imported: &Imported,
    camera: &Camera,
    seed: u64,
) -> Value {
    let name = source.path.file_name();
    tree_of!({
        "scene": name.map(|name| name.to_string_lossy()),
        "camera": camera.name,
        "seed": seed,
        "version": VERSION,
        "notes": notes(imported),
    })
}

/// Writes the index of a result, which lists its files; then `stage` ends. Reports replaced files.
pub(crate) fn finish(
    results: Results,
    mut made_from: Value,
    stage: Option<Box<dyn Progress + '_>>,
    reporter: &dyn Reporter,
) -> Result<(), Failure> {
    let finished = results.finish(|files| {
        made_from["files"] = tree_of!(files);
        json(&made_from)
    })?;
    drop(stage);
    if let Some(message) = finished.replaced_message() {
        reporter.note(&message);
    }
    Ok(())
}

/// A note if light may reach surfaces on a way that paths from the camera cannot find: from
/// a light without size, by way of a mirror or smooth glass.
fn lost_light(world: &World) -> Option<String> {
    let has_no_size = |light: &Light| !matches!(light, Light::Constant { .. } | Light::Sky(_));
    let is_smooth = world.materials.iter().any(Material::has_smooth_part);
    (is_smooth && world.lights.iter().any(has_no_size)).then(|| {
        "light of point, spot, directional and projected lights is not found behind smooth glass or mirrors, and errors of pictures do not include it; a light with a small size is found".to_owned()
    })
}

/// The camera that a viewpoint adds to the scene.
fn camera_at(viewpoint: &Viewpoint, arguments: ArgumentStyle) -> Result<Camera, Failure> {
    let Viewpoint { from, at, up, fov } = *viewpoint;
    let half_width = libm::tan(fov.to_radians() / 2.0);
    let camera = Camera::pinhole([from, at, up], half_width, [512; 2], [0.0, f64::MAX]);
    let camera = camera.ok_or_else(|| {
        let [from, at, up] = ["look_from", "look_at", "up"].map(|name| arguments.name(name));
        Failure::bad_input(format!(
            "{from} and {at} are the same point, or {up} is parallel to the line between them"
        ))
    })?;
    Ok(Camera {
        name: "command".to_owned(),
        ..camera
    })
}

/// Checks whether the scene has a light.
pub(crate) fn has_light(world: &World) -> bool {
    let shines = world.shapes.iter().any(|shape| shape.emission.is_some());
    shines || !world.lights.is_empty()
}

/// Fails if the scene has no light.
pub(crate) fn require_light(world: &World, arguments: ArgumentStyle) -> Result<(), Failure> {
    if has_light(world) {
        return Ok(());
    }
    Err(Failure::bad_input(no_light(arguments)))
}

/// The requested camera, or the first camera if none is requested, with the requested size.
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
