//! The virtual planes, for a script that records light fields with Mitsuba.

use etendue_field::{Frame, Orientation, Quantity, Side, SliceGrid, Window};
use etendue_scene::{Hit, Object, Scene};
use serde::Serialize;

/// The content of `planes.json`.
#[derive(Serialize)]
struct PlanesFile<'a> {
    /// Name of the scene.
    scene: &'a str,
    /// The frame of the exported coordinates, in the world of the scene file.
    world: Frame,
    planes: Vec<RecordedPlane<'a>>,
}

#[derive(Serialize)]
struct RecordedPlane<'a> {
    name: &'a str,
    /// The frame in the exported coordinates; on a surface X, Y and D are T, B and N.
    frame: Frame,
    orientation: Orientation,
    /// θ of the central ray, if the plane is on a surface.
    longitude: f64,
    distance: f64,
    side: Side,
    leg: usize,
    /// Identifiers of the shapes that the light has left before this plane, in order.
    visits: Vec<String>,
    /// Identifier of the shape that ends the leg, if there is one.
    ends: Option<String>,
    quantity: Quantity,
    window: Window,
    frequencies: SliceGrid,
}

pub(super) fn json(scene: &Scene) -> Vec<u8> {
    let path = &scene.path;
    let hit_id = |hit: &Hit| id(hit.object);
    let planes = scene.planes.iter().map(|plane| RecordedPlane {
        name: &plane.name,
        frame: match plane.orientation {
            Orientation::Orthogonal => path.frame_at(plane.distance, plane.leg),
            _ => path.frame.decompose(&plane.frame),
        },
        orientation: plane.orientation,
        longitude: plane.longitude,
        distance: plane.distance,
        side: plane.side,
        leg: plane.leg,
        visits: path.legs[..=plane.leg]
            .iter()
            .filter_map(|leg| leg.leaves.as_ref().map(hit_id))
            .collect(),
        ends: path.ends_at(plane.leg).map(hit_id),
        quantity: plane.quantity,
        window: plane.window,
        frequencies: plane.grid,
    });
    let file = PlanesFile {
        scene: &scene.name,
        world: scene.path.frame,
        planes: planes.collect(),
    };
    // The numbers and names are all valid in JSON.
    let mut bytes = serde_json::to_vec_pretty(&file).unwrap_or_default();
    bytes.push(b'\n');
    bytes
}

/// The identifier of an object. Names in the scene file may contain any character,
/// identifiers may not.
pub(super) fn id(object: Object) -> String {
    match object {
        Object::Surface(i) => format!("surface_{i}"),
        Object::Mesh(i) => format!("mesh_{i}"),
        Object::Patch(i) => format!("smooth_{i}"),
    }
}
