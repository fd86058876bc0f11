//! Scenes of other programs, as they are read for pictures and probes.

use etendue_import::{Imported, Options, import};
use etendue_pipeline::table::aligned;
use etendue_store::Failure;
use etendue_world::{Camera, Geometry, Light, Projection, World};
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

/// What commands say.
const NO_CAMERA: &str = "the scene has no camera: --look-from and --look-at add one";
const NO_LIGHT: &str = "the scene has no light: --sky adds one";

/// Reads a scene; causes for which it is refused come all together.
pub fn load(source: &WorldSource) -> Result<Imported, Failure> {
    let mut imported = import(&source.path, &source.options).map_err(Failure::bad_input)?;
    if source.bounces.is_some() {
        imported.world.depth = source.bounces;
    }
    if let Some(radiance) = source.sky {
        imported.world.lights.push(Light::Constant { radiance });
    }
    if let Some(viewpoint) = &source.viewpoint {
        imported.world.cameras.insert(0, camera_at(viewpoint)?);
    }
    Ok(imported)
}

/// What was left out of the scene or approximated, for result files and the terminal.
pub(crate) fn notes(imported: &Imported) -> Vec<String> {
    imported.notes.iter().map(ToString::to_string).collect()
}

/// The camera that the command line puts into the scene.
fn camera_at(viewpoint: &Viewpoint) -> Result<Camera, Failure> {
    let ahead = (viewpoint.at - viewpoint.from).try_normalize();
    let frame = ahead.and_then(|ahead| {
        let left = viewpoint.up.cross(ahead).try_normalize()?;
        Some(DMat3::from_cols(left, ahead.cross(left), ahead))
    });
    let frame = frame.ok_or_else(|| {
        let message =
            "--look-from and --look-at are one place, or --up goes along the line between them";
        Failure::bad_input(message)
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

/// Requires something that shines.
pub(crate) fn require_light(world: &World) -> Result<(), Failure> {
    let shines = world.shapes.iter().any(|shape| shape.emission.is_some());
    if shines || !world.lights.is_empty() {
        return Ok(());
    }
    Err(Failure::bad_input(NO_LIGHT))
}

/// The camera that is asked for, or the first, with the size that is asked for.
pub(crate) fn camera(world: &World, choice: &CameraChoice) -> Result<Camera, Failure> {
    let is_meant = |camera: &&Camera| choice.name.as_ref().is_none_or(|name| *name == camera.name);
    let camera = world.cameras.iter().find(is_meant).ok_or_else(|| {
        let names: Vec<&str> = world
            .cameras
            .iter()
            .map(|camera| camera.name.as_str())
            .collect();
        Failure::bad_input(match &choice.name {
            Some(name) if !names.is_empty() => {
                format!("--camera {name}; allowed: {}", names.join(", "))
            }
            _ => NO_CAMERA.to_owned(),
        })
    })?;
    Ok(Camera {
        size: choice.size.unwrap_or(camera.size),
        ..camera.clone()
    })
}

/// What a scene holds, line by line, and a note for all that was left out or approximated.
#[must_use]
pub fn contents(imported: &Imported) -> Vec<String> {
    let world = &imported.world;
    let mut lines = aligned(rows(world));
    lines.extend(world.cameras.iter().map(of_camera));
    if world.cameras.is_empty() {
        lines.push(NO_CAMERA.to_owned());
    }
    if require_light(world).is_err() {
        lines.push(NO_LIGHT.to_owned());
    }
    lines.push(match world.depth {
        Some(depth) => format!("light meets at most {depth} surfaces"),
        None => "light meets any number of surfaces".to_owned(),
    });
    lines.extend(notes(imported).iter().map(|note| format!("note: {note}")));
    lines
}

/// What there is of each kind, and how many.
fn rows(world: &World) -> Vec<Vec<String>> {
    let mut counts: Vec<(&str, usize)> = Vec::new();
    let mut count = |kind, by| match counts.iter_mut().find(|(known, _)| *known == kind) {
        Some((_, count)) => *count += by,
        None => counts.push((kind, by)),
    };
    for shape in &world.shapes {
        match &shape.geometry {
            Geometry::Rectangle => count("rectangles", 1),
            Geometry::Disc => count("discs", 1),
            Geometry::Sphere => count("spheres", 1),
            Geometry::Cylinder => count("cylinders", 1),
            Geometry::Mesh(mesh) => {
                count("meshes", 1);
                count("triangles", mesh.corners().len());
            }
        }
        if shape.emission.is_some() {
            count("area lights", 1);
        }
    }
    for light in &world.lights {
        let kind = match light {
            Light::Point { .. } => "point lights",
            Light::Spot { .. } => "spotlights",
            Light::Directional { .. } => "directional lights",
            Light::Constant { .. } => "constant environments",
            Light::Sky(_) => "environment maps",
        };
        count(kind, 1);
    }
    count("materials", world.materials.len());
    counts
        .iter()
        .map(|(kind, count)| vec![count.to_string(), (*kind).to_owned()])
        .collect()
}

fn of_camera(camera: &Camera) -> String {
    let Camera {
        name, size: [w, h], ..
    } = camera;
    let kind = match camera.projection {
        Projection::Perspective {
            half_width, lens, ..
        } => {
            let angle = 2.0 * libm::atan(half_width).to_degrees();
            let lens = lens.map_or(String::new(), |lens| {
                format!(", lens of radius {} focused at {}", lens.radius, lens.focus)
            });
            format!("perspective, {angle:.4}° wide{lens}")
        }
        Projection::Orthographic => "orthographic".to_owned(),
    };
    let name = if name.is_empty() {
        "without a name"
    } else {
        name
    };
    format!("camera {name}: {w} × {h} pixels, {kind}")
}
