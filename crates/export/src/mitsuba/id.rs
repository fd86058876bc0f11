//! Identifiers of the objects of a scene.

use etendue_scene::Object;

/// Names in the scene file may contain any character. Identifiers may not.
pub(super) fn id(object: Object) -> String {
    match object {
        Object::Surface(i) => format!("surface_{i}"),
        Object::Mesh(i) => format!("mesh_{i}"),
        Object::Patch(i) => format!("smooth_{i}"),
    }
}
