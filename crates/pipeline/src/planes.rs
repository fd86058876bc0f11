//! Selects planes of a scene by their names.

use etendue_scene::Scene;
use etendue_store::{ArgumentStyle, Failure};

/// The index of the plane with the name that the argument `plane` gives.
pub fn named(scene: &Scene, name: &str, arguments: ArgumentStyle) -> Result<usize, Failure> {
    let index = scene.planes.iter().position(|plane| plane.name == name);
    index.ok_or_else(|| {
        Failure::bad_input(format!(
            "{}: the scene has no such plane; allowed: {}",
            arguments.with("plane", name),
            names(scene)
        ))
    })
}

/// The index of the plane with this name. If no name is given, it is the only plane of the
/// scene.
pub fn chosen(
    scene: &Scene,
    name: Option<&str>,
    arguments: ArgumentStyle,
) -> Result<usize, Failure> {
    match name {
        Some(name) => named(scene, name, arguments),
        None if scene.planes.len() == 1 => Ok(0),
        None => Err(Failure::bad_input(format!(
            "the scene has several planes: select one with {}; allowed: {}",
            arguments.name("plane"),
            names(scene)
        ))),
    }
}

/// The names of all planes.
fn names(scene: &Scene) -> String {
    let all: Vec<&str> = scene.planes.iter().map(|p| p.name.as_str()).collect();
    all.join(", ")
}
