//! Random colours.

use super::draw::{SceneDraw, rounded};
use etendue_scene::{Color, SceneFile};
use serde_json::Value;
use std::io;
use std::path::Path;

/// The seed of colours is the seed of the search with these bits flipped, so colours have their own
/// random numbers.
const OWN: u64 = 0x636f_6c6f_7273;
/// The fields that are numbers or colours.
const COLORED: [&str; 6] = ["radiance", "intensity", "irradiance", "albedo", "n", "k"];
/// The smallest number that is divided into colours.
const LEAST: f64 = 1e-6;
/// The smallest index of refraction of a scene file.
const LEAST_INDEX: f64 = 0.05;

/// Gives colours to the scene with this index for this seed, and selects a channel. No channel
/// exceeds the number that it replaces.
pub(super) fn add_colors(file: &SceneFile, of: (u64, u64), folder: &Path) -> io::Result<SceneFile> {
    let mut draw = SceneDraw::apart(OWN, of, folder);
    let mut tree = serde_json::to_value(file)?;
    colored(&mut tree, &mut draw);
    let mut file: SceneFile = serde_json::from_value(tree)?;
    file.run.color = draw.pick(&Color::ALL).1;
    Ok(file)
}

fn colored(node: &mut Value, draw: &mut SceneDraw) {
    match node {
        Value::Object(fields) => {
            for (name, value) in fields {
                match value.as_f64() {
                    Some(number) if COLORED.contains(&name.as_str()) && number > LEAST => {
                        let least = if name == "n" { LEAST_INDEX } else { 0.0 };
                        let of =
                            [(); 3].map(|()| rounded(number * draw.between(0.1, 1.0)).max(least));
                        *value = of.to_vec().into();
                    }
                    _ => colored(value, draw),
                }
            }
        }
        Value::Array(all) => all.iter_mut().for_each(|value| colored(value, draw)),
        _ => {}
    }
}
