//! The scenes that test shading in 4D.

use crate::scenes::emit;
use etendue_scene::{Scene, SceneFile, resolve};

macro_rules! scene {
    ($name:literal, $file:literal) => {
        (
            $name,
            include_str!(concat!("../../../scenes/", $file, ".ron")),
        )
    };
}

const SCENES: &[(&str, &str)] = &[
    scene!("fig10", "fig10"),
    scene!("textured_glossy", "table1/textured_glossy"),
    scene!("fresnel_grazing", "table1/fresnel_grazing"),
    scene!("checkerboard", "table1/checkerboard"),
    scene!("environment", "table1/environment"),
    scene!("twisted_glossy", "table1/twisted_glossy"),
    scene!("ggx_sphere", "table1/ggx_sphere"),
    scene!("weighted", "table1/weighted"),
    scene!("sum", "table1/sum"),
    scene!("factor_incoming", "table1/factor_incoming"),
    scene!("factor_outgoing", "table1/factor_outgoing"),
    scene!("fresnel_aluminium", "table1/fresnel_aluminium"),
    scene!("fresnel_diamond", "table1/fresnel_diamond"),
    scene!("semi_convolution", "table1/semi_convolution"),
    // A misprint about mirrors is tested with this scene, which is among the scenes of Table 1.
    scene!("concave_oblique", "table1/concave_oblique"),
];

/// The number of scenes that scatter light. These are all scenes of the list except the last.
const SHADED: usize = 14;

/// Returns every scene that scatters light. If `photons` is `None`, each scene has the number of
/// photons in its file.
pub(super) fn all(photons: Option<u64>) -> Vec<Scene> {
    let shaded = SCENES[..SHADED].iter();
    shaded
        .map(|(name, _)| changed(name, photons, &[]))
        .collect()
}

/// Returns a scene of the repository after the given replacements of text in its file, made in the
/// given order.
///
/// # Panics
/// Panics if there is no such scene, if its file does not contain one of the texts, or if the
/// changed scene is invalid.
pub(super) fn changed(name: &str, photons: Option<u64>, texts: &[[&str; 2]]) -> Scene {
    let found = SCENES.iter().find(|(known, _)| *known == name);
    let (_, text) = found.expect("a scene of shading");
    let text = texts.iter().fold((*text).to_owned(), |text, [old, new]| {
        assert!(text.contains(old), "{name} has no {old}");
        text.replace(old, new)
    });
    let mut file = SceneFile::parse(&text).expect("a scene of shading is a scene file");
    emit(&mut file.run, photons);
    resolve(name, file, ".".as_ref(), u64::MAX).expect("a scene of shading is sound")
}

/// Returns a scene reduced to one of its planes, so that all photons are aimed at the window of
/// this plane.
///
/// # Panics
/// Panics if there is no such plane.
pub(super) fn alone(mut scene: Scene, plane: &str) -> Scene {
    scene.planes.retain(|p| p.name == plane);
    assert_eq!(scene.planes.len(), 1, "{} has no {plane}", scene.name);
    scene
}
