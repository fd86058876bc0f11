//! Random scenes for the tracer of scene files.

use super::draw::SceneDraw;
use super::lights::add_lights;
use super::scene;
use super::small::{object, plane};
use etendue_field::Profile;
use etendue_scene::{AxisFile, Emission, Sampling, Scene, SceneFile, WindowFile, resolve};
use std::path::Path;

/// The seed of what is added is the seed of the scene with these bits flipped.
const OWN: u64 = 0x70_6c61_696e;
/// Range of the ratio of an added object's width to the width of the light.
const WIDE: [f64; 2] = [0.05, 0.6];
/// Factor by which the windows of scenes with several surfaces are wider.
const WIDER: f64 = 2.0;
/// Maximum number of attempts to find a scene, and to place an object.
const TRIES: u64 = 16;

/// The scene with this index for this seed, mostly with several lights, with one plane at
/// a distance on the path, and in half of the scenes with an object anywhere in the light. Returns
/// `None` if no scene was found.
pub(crate) fn plain_scene(seed: u64, index: u64, photons: u64, folder: &Path) -> Option<SceneFile> {
    // Extreme values leave the windows of most scenes dark.
    let usual = (index * TRIES..(index + 1) * TRIES)
        .find(|index| SceneDraw::new(seed, *index, folder).is_usual());
    let index = usual?;
    let mut file = scene(seed, index, photons, folder).ok()?;
    // Scattered light is dim, so more of it is let in.
    if file.surfaces.len() > 1 {
        let WindowFile { x, y, u, v } = &mut file.window;
        for profile in [Some(x), y.as_mut(), Some(u), v.as_mut()] {
            profile.into_iter().for_each(widen);
        }
    }
    // The comparison depends neither on these nor on other frequencies.
    (file.run.emission, file.run.sampling) = (Emission::Aimed, Sampling::Lattice);
    file.frequencies.azimuths = 1;
    for axis in [&mut file.frequencies.rho, &mut file.frequencies.nu] {
        *axis = AxisFile {
            max: 0.1 * axis.max,
            spacing: None,
        };
    }
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

fn widen(profile: &mut Profile) {
    match profile {
        Profile::Hann(half) | Profile::Box(half) => *half *= WIDER,
        Profile::Gaussian { width, cut } => {
            *width *= WIDER;
            *cut *= WIDER;
        }
    }
}
