//! Selects planes of a scene by their names.

use etendue_scene::Scene;
use etendue_store::Failure;

/// Returns the index of the plane with the name that `--plane` gives.
pub(crate) fn named(scene: &Scene, name: &str) -> Result<usize, Failure> {
    let index = scene.planes.iter().position(|plane| plane.name == name);
    index.ok_or_else(|| {
        Failure::bad_input(format!(
            "--plane {name}: the scene has no such plane; allowed: {}",
            names(scene)
        ))
    })
}

/// Returns the names of all planes.
pub(crate) fn names(scene: &Scene) -> String {
    let all: Vec<&str> = scene.planes.iter().map(|p| p.name.as_str()).collect();
    all.join(", ")
}
