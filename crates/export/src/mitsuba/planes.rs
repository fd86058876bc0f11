//! The virtual planes, for a script that records light fields with Mitsuba.

use super::{mesh_id, surface_id};
use etendue_field::{Frame, Quantity, Side, SliceGrid, Window};
use etendue_scene::{CentralRay, Scene};
use glam::DVec3;
use serde::Serialize;

/// `planes.json`.
#[derive(Serialize)]
struct PlanesFile<'a> {
    /// Name of the scene.
    scene: &'a str,
    /// The frame of the exported coordinates, in the world of the scene file.
    world: Frame,
    planes: Vec<Plane<'a>>,
}

#[derive(Serialize)]
struct Plane<'a> {
    name: &'a str,
    /// In the exported coordinates.
    frame: Frame,
    distance: f64,
    side: Side,
    reflections: usize,
    /// Identifier of the shape that light leaves last, if any reflects it.
    leaves: Option<String>,
    quantity: Quantity,
    window: Window,
    frequencies: SliceGrid,
}

pub(super) fn json(scene: &Scene) -> Vec<u8> {
    let path = CentralRay {
        frame: Frame {
            origin: DVec3::ZERO,
            x: DVec3::X,
            y: DVec3::Y,
            d: DVec3::Z,
        },
        ..scene.path
    };
    let planes = scene.planes.iter().map(|plane| Plane {
        name: &plane.name,
        frame: path.frame_at(plane.distance, plane.reflections),
        distance: plane.distance,
        side: plane.side,
        reflections: plane.reflections,
        leaves: visited(scene).filter(|_| plane.reflections > 0),
        quantity: plane.quantity,
        window: plane.window,
        frequencies: plane.grid,
    });
    let file = PlanesFile {
        scene: &scene.name,
        world: scene.path.frame,
        planes: planes.collect(),
    };
    // Numbers and names: nothing that JSON cannot hold.
    let mut bytes = serde_json::to_vec_pretty(&file).unwrap_or_default();
    bytes.push(b'\n');
    bytes
}

/// Identifier of the surface that the central ray visits.
fn visited(scene: &Scene) -> Option<String> {
    let is_visited = |name: &String| scene.file.path.visits.contains(name);
    let flat = scene.surfaces.iter().position(|s| is_visited(&s.name));
    let mesh = scene.meshes.iter().position(|m| is_visited(&m.name));
    flat.map(surface_id).or(mesh.map(mesh_id))
}
