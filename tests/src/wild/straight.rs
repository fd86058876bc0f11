//! Moves and rotates a scene so that its central ray begins at the origin along z.

use etendue_field::Frame;
use glam::DVec3;
use serde_json::{Value, json};

/// Fields that hold a world direction.
const DIRECTIONS: [&str; 7] = [
    "facing",
    "along",
    "direction",
    "x_axis",
    "leaves",
    "up",
    "front",
];

/// The scene in the frame at its light, or `None` if the scene is already in this frame.
///
/// Meshes are not rotated, so a run must show whether a rotated scene with meshes still has the
/// fault.
pub(super) fn straightened(tree: &Value) -> Option<Value> {
    let vector = |value: &Value| -> Option<DVec3> { serde_json::from_value(value.clone()).ok() };
    let light = tree.get("light")?.as_object()?.values().next()?;
    let origin = vector(light.get("center")?)?;
    let path = tree.get("path")?;
    let frame = Frame::new(
        origin,
        vector(&path["direction"])?,
        vector(&path["x_axis"])?,
    )?;
    if frame == Frame::IDENTITY {
        return None;
    }
    let mut moved = tree.clone();
    turn(&mut moved, &frame);
    (moved != *tree).then_some(moved)
}

fn turn(tree: &mut Value, frame: &Frame) {
    match tree {
        Value::Object(fields) => {
            for (key, value) in fields {
                let place: Option<DVec3> = serde_json::from_value(value.clone()).ok();
                match place {
                    Some(place) if key == "center" => {
                        *value = json!(tidy(frame.to_local(place)));
                    }
                    Some(place) if DIRECTIONS.contains(&key.as_str()) => {
                        *value = json!(tidy(frame.vector_to_local(place)));
                    }
                    _ => turn(value, frame),
                }
            }
        }
        Value::Array(elements) => elements.iter_mut().for_each(|value| turn(value, frame)),
        _ => {}
    }
}

/// Removes rounding errors.
fn tidy(v: DVec3) -> [f64; 3] {
    let largest = v.abs().max_element();
    v.to_array().map(|x| {
        let near = format!("{x:.9e}").parse().unwrap_or(x);
        if x.abs() < 1e-12 * largest { 0.0 } else { near }
    })
}
