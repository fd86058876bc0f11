//! The scenes that test the paper's Table 1.

use crate::scenes::emit;
use etendue_scene::{Scene, SceneFile, resolve};

macro_rules! scene {
    ($name:literal) => {
        (
            $name,
            include_str!(concat!("../../../scenes/table1/", $name, ".ron")),
        )
    };
}

const SCENES: &[(&str, &str)] = &[
    scene!("travel"),
    scene!("incidence"),
    scene!("incidence_grazing"),
    scene!("convex_normal"),
    scene!("convex_oblique"),
    scene!("convex_grazing"),
    scene!("concave_normal"),
    scene!("concave_oblique"),
    scene!("concave_grazing"),
    scene!("cylinder"),
    scene!("paraboloid"),
    scene!("twist"),
    scene!("solar_oven"),
    scene!("two_mirrors"),
    scene!("lens"),
    scene!("ball_lens"),
    scene!("refraction_in"),
    scene!("refraction_out"),
    scene!("mesh_mirror"),
    scene!("printed_incidence"),
    scene!("printed_outgoing"),
    scene!("printed_curvature"),
    scene!("printed_sagittal"),
];

/// Returns every scene that tests Table 1. If `photons` is `None`, each scene has the number of
/// photons in its file.
///
/// # Panics
/// Panics if a scene is invalid.
pub(super) fn all(photons: Option<u64>) -> Vec<Scene> {
    let resolved = SCENES.iter().map(|(name, text)| {
        let mut file = SceneFile::parse(text).expect("a scene of the table is a scene file");
        emit(&mut file.run, photons);
        resolve(name, file, ".".as_ref(), u64::MAX).expect("a scene of the table is sound")
    });
    resolved.collect()
}
