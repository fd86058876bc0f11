//! Mutated scene files. Test that reading any file as a scene gives a scene or an error, never a
//! panic.

use crate::common::photons;
use etendue_compare::compare;
use etendue_field::Mask;
use etendue_predict::{Applicability, predict, test_of};
use etendue_scene::{Scene, SceneFile, Triangles, resolve};
use etendue_transform::random::{self, Stream};
use rayon::prelude::*;

/// Scenes that together contain every kind of light, blocker and plane; the first scene is
/// mutated most often.
const SCENES: [&str; 7] = [
    include_str!("../../scenes/fig9b.ron"),
    include_str!("../../scenes/disc_light.ron"),
    include_str!("../../scenes/two_lights.ron"),
    include_str!("../../scenes/fig4_point.ron"),
    include_str!("../../scenes/fig4_spot.ron"),
    include_str!("../../scenes/two_layers.ron"),
    include_str!("../../scenes/mesh_blocker.ron"),
];

/// Critical numbers and words.
const TOKENS: &str = "0 -0.0 -1 1e-9 1e9 1e308 -1e308 5e-324 NaN inf -inf 4294967296 \
    18446744073709551616 1000000 0.5 2 33 \"\" \"floor\" () [] Emission Box(0.1) \
    After(\"blockers\")";

/// Random numbers for one mutation.
struct Dice {
    index: u64,
    block: u32,
}

impl Dice {
    fn below(&mut self, n: usize) -> usize {
        self.block += 1;
        let word = random::words(11, Stream::Photon, self.index, self.block)[0];
        (word as usize) % n.max(1)
    }
}

/// Returns a scene file that is cut short, or has one to three tokens replaced, removed or
/// doubled.
fn mutated(index: u64) -> String {
    let mut dice = Dice { index, block: 0 };
    let scene = SCENES[dice.below(2 * SCENES.len()).saturating_sub(SCENES.len())];
    let body: String = scene
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default())
        .collect();
    let mut tokens = split(&body);
    for _ in 0..=dice.below(3) {
        let at = dice.below(tokens.len());
        match dice.below(8) {
            0 => drop(tokens.remove(at)),
            1 => tokens.insert(at, tokens[at].clone()),
            2 => tokens.truncate(at.max(1)),
            // Most mutations replace a number, so that many keep the syntax valid.
            _ => {
                let numbers: Vec<usize> = (0..tokens.len())
                    .filter(|i| tokens[*i].starts_with(|c: char| c.is_ascii_digit()))
                    .collect();
                let at = if numbers.is_empty() {
                    at
                } else {
                    numbers[dice.below(numbers.len())]
                };
                let words: Vec<&str> = TOKENS.split(' ').collect();
                tokens[at] = words[dice.below(words.len())].to_owned();
            }
        }
    }
    tokens.concat()
}

/// Splits a text into words, numbers and single characters.
fn split(text: &str) -> Vec<String> {
    let mut tokens: Vec<String> = Vec::new();
    let word = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
    for c in text.chars() {
        match tokens.last_mut() {
            Some(last) if word(c) && last.ends_with(word) => last.push(c),
            _ => tokens.push(c.to_string()),
        }
    }
    tokens
}

#[test]
fn no_mutated_scene_file_panics() {
    // `etendue-validation hostile` tries more mutations.
    let found: Vec<[bool; 2]> = (0..4_000).into_par_iter().map(tried).collect();
    let count = |k: usize| found.iter().filter(|found| found[k]).count();
    let [sound, run] = [count(0), count(1)];
    // The mutations are useful: some mutated files are refused, and others are valid scenes.
    assert!(sound > 200 && run > 12, "{sound} sound scenes, {run} run");
}

/// Returns whether a mutated file is a valid scene, and whether this scene was run.
fn tried(index: u64) -> [bool; 2] {
    let text = mutated(index);
    let resolved =
        SceneFile::parse(&text).and_then(|file| resolve("fuzz", file, ".".as_ref(), 1_000_000_000));
    let mut scene = match resolved {
        Ok(scene) => scene,
        Err(error) => {
            let told = error.in_text(&text, &[]);
            assert!(
                told.lines().any(|line| line.starts_with("line 1, column ")),
                "{told}: {text}"
            );
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
    let measurement = photons(scene);
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
