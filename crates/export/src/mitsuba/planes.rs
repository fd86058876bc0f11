//! The virtual planes, for a script that records light fields with Mitsuba.

use super::{mesh_id, surface_id};
use etendue_field::{Frame, Quantity, Side, SliceGrid, Window};
use etendue_scene::{Object, Scene};
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
    leg: usize,
    /// Identifier of the shape that light leaves last, if any reflects it.
    leaves: Option<String>,
    quantity: Quantity,
    window: Window,
    frequencies: SliceGrid,
}

pub(super) fn json(scene: &Scene) -> Vec<u8> {
    let planes = scene.planes.iter().map(|plane| Plane {
        name: &plane.name,
        frame: scene.path.frame_at(plane.distance, plane.leg),
        distance: plane.distance,
        side: plane.side,
        leg: plane.leg,
        leaves: scene.path.legs[plane.leg]
            .leaves
            .and_then(|hit| shape_id(hit.object)),
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

fn shape_id(object: Object) -> Option<String> {
    match object {
        Object::Surface(i) => Some(surface_id(i)),
        Object::Mesh(i) => Some(mesh_id(i)),
        Object::Patch(_) => None,
    }
}
