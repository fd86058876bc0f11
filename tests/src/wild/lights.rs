//! Random further lights.

use super::draw::SceneDraw;
use super::light::light;
use etendue_scene::{LightFile, SceneFile, resolve};
use glam::DVec3;
use std::io;
use std::path::Path;

/// The seed of further lights is the seed of the search with these bits flipped, so further lights
/// have their own random numbers.
const OWN: u64 = 0x6c69_6768_7473;

/// Adds one to three further lights to the scene with this index for this seed.
pub(super) fn add_lights(file: &mut SceneFile, of: (u64, u64), folder: &Path) -> io::Result<()> {
    let mut draw = SceneDraw::apart(OWN, of, folder);
    let Ok(scene) = resolve("wild", file.clone(), folder, u64::MAX) else {
        return Ok(());
    };
    let first = scene.path.first_hit();
    for _ in 0..*draw.pick(&[1, 1, 2, 3]) {
        let mut next = light(&mut draw)?;
        let depth = first * draw.between(-0.5, 0.9);
        let depth = *draw.pick(&[0.0, depth]);
        let aside = [(); 2].map(|()| draw.unit * draw.between(-0.5, 0.5));
        let place = match next {
            LightFile::Rectangle { .. } | LightFile::Disc { .. } | LightFile::Spot { .. } => {
                DVec3::new(aside[0], aside[1], depth)
            }
            _ => DVec3::Z * depth,
        };
        *center(&mut next) = draw.place(place);
        file.other_lights.push(next);
        // A light that would stand behind a surface, or beyond all planes, is removed.
        if resolve("wild", file.clone(), folder, u64::MAX).is_err() {
            file.other_lights.pop();
        }
    }
    Ok(())
}

fn center(light: &mut LightFile) -> &mut [f64; 3] {
    match light {
        LightFile::Rectangle { center, .. }
        | LightFile::Disc { center, .. }
        | LightFile::Point { center, .. }
        | LightFile::Spot { center, .. }
        | LightFile::Projector { center, .. }
        | LightFile::Beam { center, .. }
        | LightFile::Environment { center, .. }
        | LightFile::Rays { center, .. } => center,
    }
}
