//! Tests that reading any file as a scene gives a scene or an error, never a panic.

use super::dice::Dice;
use super::scenes;
use crate::scenes::traced;
use etendue_compare::compare;
use etendue_field::Mask;
use etendue_predict::{Applicability, predict, test_of};
use etendue_scene::{Scene, SceneFile, Triangles, resolve};
use rayon::prelude::*;

#[test]
fn no_mutated_scene_file_panics() {
    // `etendue-validation hostile` tries more mutations.
    let seeds = scenes::seeds().unwrap();
    let tried = |index| tried(&seeds, index);
    let found: Vec<[bool; 2]> = (0..4_000).into_par_iter().map(tried).collect();
    let count = |k: usize| found.iter().filter(|found| found[k]).count();
    let [sound, run] = [count(0), count(1)];
    // The mutations are useful: some mutated files are refused, and others are valid scenes.
    assert!(sound > 200 && run > 12, "{sound} sound scenes, {run} run");
}

/// Whether a mutated file is a valid scene, and whether this scene was run.
fn tried(seeds: &[String], index: u64) -> [bool; 2] {
    let (_, text) = scenes::mutated(seeds, &mut Dice::new(11, index));
    let text = String::from_utf8_lossy(&text);
    let resolved =
        SceneFile::parse(&text).and_then(|file| resolve("fuzz", file, ".".as_ref(), 1_000_000_000));
    let mut scene = match resolved {
        Ok(scene) => scene,
        Err(error) => {
            let told = error.in_text(&text, &[]);
            let is_placed = |line: &str| line.starts_with("line ") && line.contains(", column ");
            assert!(told.lines().any(is_placed), "{told}: {text}");
            return [false; 2];
        }
    };
    let is_run = index.is_multiple_of(16);
    if is_run {
        make_small(&mut scene);
        whole_run(&scene);
    }
    [true, is_run]
}

/// Reduces the numbers of photons, frequencies and blockers of a scene. The test concerns values of
/// fields, and small numbers save time.
fn make_small(scene: &mut Scene) {
    scene.run.photons = 200;
    scene.run.batches = 32;
    for plane in &mut scene.planes {
        plane.grid.azimuths = plane.grid.azimuths.min(3);
        plane.grid.rho.half = plane.grid.rho.half.min(3);
        plane.grid.nu.half = plane.grid.nu.half.min(3);
    }
    for layer in &mut scene.blockers {
        if let Mask::Opaque { shapes, .. } = &mut layer.mask {
            shapes.truncate(20);
        }
    }
    for mesh in &mut scene.meshes {
        let some = mesh.triangles.iter().take(200).copied().collect();
        mesh.triangles = Triangles::new(some, 0.0);
    }
    // A prediction at a receiver takes seconds even if there are few frequencies.
    scene.planes.retain(|plane| plane.leg == 0);
}

fn whole_run(scene: &Scene) {
    let measurement = traced(scene);
    let test = test_of(scene);
    for (i, plane) in scene.planes.iter().enumerate() {
        let prediction = predict(scene, plane, &Applicability::new(scene, plane));
        assert!(
            prediction.slices.half.iter().all(|s| s.is_finite()),
            "{plane:?}"
        );
        // If too many batches contain no photon, the result is an error, not a panic.
        if let Ok(comparison) = compare(&measurement, i, &prediction, &test) {
            assert!(
                comparison.radial.power.iter().all(|p| p.is_finite()),
                "{plane:?}"
            );
        }
    }
}
