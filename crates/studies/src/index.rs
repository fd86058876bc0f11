//! The index of a study.

use etendue_scene::Scene;
use etendue_store::VERSION;
use serde_json::{Value, json};

/// The content of an index with the scene that it belongs to.
pub(crate) fn with_scene(mut tree: Value, scene: &Scene) -> Value {
    tree["scene"] = scene.name.as_str().into();
    tree["scene_hash"] = json!(scene.hash());
    tree["scene_file"] = json!(scene.file);
    tree["version"] = json!(VERSION);
    tree
}
