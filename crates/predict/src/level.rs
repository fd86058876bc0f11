//! The test of the planes of a scene.

use etendue_compare::{TESTS, Test, sidak};
use etendue_scene::Scene;

/// The test of a scene, with the level α for all tests of its planes together.
#[must_use]
pub fn test_of(scene: &Scene) -> Test {
    test_each(scene, TESTS)
}

/// The test of a scene in which each plane is tested `times` times, with the level α for all
/// tests together.
#[must_use]
pub fn test_each(scene: &Scene, times: usize) -> Test {
    let run = &scene.run;
    Test {
        level: sidak(run.alpha, times * scene.planes.len()),
        resolution: run.resolution,
        seed: run.seed,
    }
}
