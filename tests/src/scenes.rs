//! The scene all validation is made on, and the measurement of it.

use etendue_compare::Prediction;
use etendue_field::PhotonSource;
use etendue_scene::{Scene, SceneFile, resolve};
use etendue_spectrum::{Measurement, measure};
use etendue_trace::Tracer;

const FIG9B: &str = include_str!("../../scenes/fig9b.ron");

/// `fig9b` with a number of photons and a seed.
///
/// # Panics
/// When the scene in the repository is not sound.
pub(crate) fn fig9b(photons: u64, seed: u64) -> Scene {
    let mut file = SceneFile::parse(FIG9B).expect("scenes/fig9b.ron is a scene file");
    file.run.photons = photons;
    file.run.seed = seed;
    resolve("fig9b", file, ".".as_ref(), u64::MAX).expect("scenes/fig9b.ron is sound")
}

/// `fig9b` with the receiver plane alone: all photons are aimed at its window.
pub(crate) fn receiver(photons: u64, seed: u64) -> Scene {
    let mut scene = fig9b(photons, seed);
    scene.planes.retain(|plane| plane.name == "receiver");
    scene
}

/// Measures a scene with photons from `source`.
pub(crate) fn measured(scene: &Scene, source: &impl PhotonSource) -> Measurement {
    measure(source, &scene.planes, 0..scene.run.batches, &|_| ())
}

/// Measures a scene with its own tracer.
pub(crate) fn traced(scene: &Scene) -> Measurement {
    measured(scene, &Tracer::new(scene))
}

/// The predictions of all planes of a scene.
pub(crate) fn predicted(scene: &Scene) -> Vec<Prediction> {
    scene
        .planes
        .iter()
        .map(|plane| Prediction::new(scene, plane))
        .collect()
}
