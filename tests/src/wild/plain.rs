//! Random scenes for the tracer of scene files.

use super::draw::SceneDraw;
use super::lights::add_lights;
use super::scene;
use super::small::{object, plane};
use etendue_scene::{Scene, SceneFile, resolve};
use std::path::Path;

/// The seed of what is added is the seed of the scene with these bits flipped.
const OWN: u64 = 0x70_6c61_696e;
/// Range of the ratio of an added object's width to the width of the light.
const WIDE: [f64; 2] = [0.05, 0.6];
/// Maximum number of attempts to find a scene, and to place an object.
const TRIES: u64 = 16;

/// Returns the scene with this index for this seed, mostly with several lights, with one plane at
/// a distance on the path, and in half of the scenes with an object anywhere in the light. Returns
/// `None` if no scene was found.
pub(crate) fn plain_scene(seed: u64, index: u64, photons: u64, folder: &Path) -> Option<SceneFile> {
    // Extreme values leave the windows of most scenes dark.
    let usual = (index * TRIES..(index + 1) * TRIES)
        .find(|index| SceneDraw::new(seed, *index, folder).is_usual());
    let index = usual?;
    let mut file = scene(seed, index, photons, folder).ok()?;
    let mut draw = SceneDraw::apart(OWN, (seed, index), folder);
    if !draw.one_in(4) {
        add_lights(&mut file, (seed, index), folder).ok()?;
    }
    let resolved = |file: &SceneFile| -> Option<Scene> {
        resolve("plain", file.clone(), folder, u64::MAX).ok()
    };
    file.planes = vec![plane(&mut draw, &resolved(&file)?)];
    let open = resolved(&file)?;
    if draw.one_in(2) {
        for _ in 0..TRIES {
            let mut with_object = file.clone();
            object(&mut draw, &open, &mut with_object, WIDE);
            if resolved(&with_object).is_some() {
                return Some(with_object);
            }
        }
    }
    Some(file)
}
