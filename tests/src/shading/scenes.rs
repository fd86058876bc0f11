//! The scenes that test shading in 4D.

use crate::scenes::{emit, sound, text};
use etendue_scene::{Scene, SceneFile};

/// The scenes that scatter light.
const SCENES: &str = "fig10 textured_glossy fresnel_grazing checkerboard environment \
    twisted_glossy ggx_sphere weighted sum factor_incoming factor_outgoing fresnel_aluminium \
    fresnel_diamond semi_convolution";

/// Every scene that scatters light. If `photons` is `None`, each scene has the number of
/// photons in its file.
pub(super) fn all(photons: Option<u64>) -> Vec<Scene> {
    let scene = |name| changed(name, photons, &[]);
    SCENES.split(' ').map(scene).collect()
}

/// A scene of the repository after the given replacements of text in its file.
///
/// # Panics
/// Panics if there is no such scene, if its file does not contain one of the texts, or if the
/// changed scene is invalid.
pub(super) fn changed(name: &str, photons: Option<u64>, edits: &[(&str, &str)]) -> Scene {
    let folder = if name == "fig10" { "" } else { "table1/" };
    let text = text(&format!("{folder}{name}"), edits);
    let mut file = SceneFile::parse(&text).expect("a scene of shading is a scene file");
    emit(&mut file.run, photons);
    sound(name, file)
}

/// A scene reduced to one of its planes, so that all photons are aimed at the window of
/// this plane.
///
/// # Panics
/// Panics if there is no such plane.
pub(super) fn alone(mut scene: Scene, plane: &str) -> Scene {
    scene.planes.retain(|p| p.name == plane);
    assert_eq!(scene.planes.len(), 1, "{} has no {plane}", scene.name);
    scene
}
