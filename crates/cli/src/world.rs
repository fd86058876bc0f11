//! Scenes of other programs, as commands take them.

use crate::args::{CameraArgs, ImportArgs, ViewArgs, WorldArgs};
use crate::print::deliver;
use etendue_import::{Imported, import};
use etendue_pipeline::table::aligned;
use etendue_store::Failure;
use etendue_world::{Camera, Geometry, Light, Projection, World};
use glam::{DAffine3, DMat3};

/// What commands say.
const NO_CAMERA: &str = "the scene has no camera: --look-from and --look-at add one";
const NO_LIGHT: &str = "the scene has no light: --sky adds one";

/// Reads the scene named on the command line; causes for which it is refused come all together.
pub(crate) fn load(args: &WorldArgs) -> Result<Imported, Failure> {
    let mut imported = import(&args.path, &args.options()).map_err(Failure::bad_input)?;
    if args.bounces.is_some() {
        imported.world.depth = args.bounces;
    }
    if let Some(radiance) = args.sky {
        imported.world.lights.push(Light::Constant { radiance });
    }
    if let Some(camera) = of_command(&args.view)? {
        imported.world.cameras.insert(0, camera);
    }
    Ok(imported)
}

/// What was left out of the scene or approximated, for result files and the terminal.
pub(crate) fn notes(imported: &Imported) -> Vec<String> {
    imported.notes.iter().map(ToString::to_string).collect()
}

/// The camera that the command line puts into the scene.
fn of_command(view: &ViewArgs) -> Result<Option<Camera>, Failure> {
    let (Some(from), Some(at)) = (view.look_from, view.look_at) else {
        return Ok(None);
    };
    let ahead = (at - from).try_normalize();
    let frame = ahead.and_then(|ahead| {
        let left = view.up.cross(ahead).try_normalize()?;
        Some(DMat3::from_cols(left, ahead.cross(left), ahead))
    });
    let frame = frame.ok_or_else(|| {
        let message =
            "--look-from and --look-at are one place, or --up goes along the line between them";
        Failure::bad_input(message)
    })?;
    Ok(Some(Camera {
        name: "command".to_owned(),
        to_world: DAffine3::from_mat3_translation(frame, from),
        size: [512; 2],
        projection: Projection::Perspective {
            half_width: libm::tan(view.fov.to_radians() / 2.0),
            shift: [0.0; 2],
            lens: None,
        },
        clip: [0.0, f64::MAX],
    }))
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
pub(crate) fn camera(world: &World, args: &CameraArgs) -> Result<Camera, Failure> {
    let is_meant = |camera: &&Camera| args.name.as_ref().is_none_or(|name| *name == camera.name);
    let camera = world.cameras.iter().find(is_meant).ok_or_else(|| {
        let names: Vec<&str> = world
            .cameras
            .iter()
            .map(|camera| camera.name.as_str())
            .collect();
        Failure::bad_input(match &args.name {
            Some(name) if !names.is_empty() => {
                format!("--camera {name}; allowed: {}", names.join(", "))
            }
            _ => NO_CAMERA.to_owned(),
        })
    })?;
    Ok(Camera {
        size: args.size.unwrap_or(camera.size),
        ..camera.clone()
    })
}

/// `etendue import`: returns the exit code.
pub(crate) fn report(args: &ImportArgs) -> Result<u8, Failure> {
    let imported = load(&args.scene)?;
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
    lines.extend(notes(&imported).iter().map(|note| format!("note: {note}")));
    deliver(&lines.join("\n"))?;
    Ok(0)
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
