//! Entries of an MTL file with their pictures, and the surfaces made from them.

use crate::range::MAX_NUMBER;
use crate::report::{Report, SourcePlace};
use etendue_world::{Texture, Wrap};
use glam::{DAffine2, DVec2};
use std::path::PathBuf;

/// The known options, each with the maximum number of its values.
const OPTIONS: [(&str, usize); 13] = [
    ("-o", 3),
    ("-s", 3),
    ("-t", 3),
    ("-clamp", 1),
    ("-blendu", 1),
    ("-blendv", 1),
    ("-boost", 1),
    ("-bm", 1),
    ("-cc", 1),
    ("-imfchan", 1),
    ("-mm", 2),
    ("-texres", 1),
    ("-type", 1),
];

/// A material as it is written in an MTL file.
#[derive(Clone, Debug, Default)]
pub(super) struct MtlEntry {
    /// The position in the file where the material begins.
    pub(super) place: SourcePlace,
    /// Diffuse reflectance.
    pub(super) kd: Option<[f64; 3]>,
    /// Specular reflectance.
    pub(super) ks: Option<[f64; 3]>,
    /// Emitted radiance.
    pub(super) ke: Option<[f64; 3]>,
    /// Transmission filter.
    pub(super) tf: Option<[f64; 3]>,
    /// Exponent of the specular lobe.
    pub(super) ns: Option<f64>,
    /// Index of refraction.
    pub(super) ni: Option<f64>,
    /// Opacity.
    pub(super) d: Option<f64>,
    /// Illumination model, 0 to 10.
    pub(super) illum: Option<u32>,
    pub(super) map_kd: Option<MtlMap>,
    pub(super) map_ke: Option<MtlMap>,
    pub(super) map_d: Option<MtlMap>,
}

/// The surface of a part.
#[derive(Clone, Debug)]
pub(super) struct ObjSurface {
    pub(super) material: usize,
    pub(super) emission: Option<Texture>,
    /// Whether the surface has a picture, which needs texture coordinates.
    pub(super) has_picture: bool,
}

/// A picture and its placement.
#[derive(Clone, Debug)]
pub(super) struct MtlMap {
    pub(super) place: SourcePlace,
    pub(super) file: String,
    /// The folder in which the picture is searched for.
    pub(super) folder: PathBuf,
    /// The map from (u, v) of a world to (u, v) of the picture; v points downwards in both.
    pub(super) to_uv: DAffine2,
    pub(super) wrap: Wrap,
}

impl MtlMap {
    /// Parses the text after the keyword; `None` if a cause of refusal was reported.
    pub(super) fn read(
        text: &str,
        place: SourcePlace,
        folder: PathBuf,
        report: &Report,
    ) -> Option<Self> {
        let (mut scale, mut offset, mut wrap) = (DVec2::ONE, DVec2::ZERO, Wrap::Repeat);
        let mut rest = text.trim();
        while rest.starts_with('-') {
            let (word, after) = cut(rest);
            let Some((option, most)) = OPTIONS.iter().find(|(known, _)| *known == word) else {
                // If a word begins with a hyphen but is not a known option, it is a file name.
                break;
            };
            let (values, after) = arguments(after, *most, option);
            rest = after;
            match *option {
                "-s" => scale = pair(&values, 1.0),
                "-o" => offset = pair(&values, 0.0),
                "-clamp" if values.first() == Some(&"on") => wrap = Wrap::Clamp,
                "-clamp" | "-blendu" | "-blendv" => {}
                _ => report.note(&place, format!("option {option} is left out")),
            }
        }
        if rest.is_empty() {
            return report.refuse(&place, "does not name a file");
        }
        if !(scale.abs().max_element() <= MAX_NUMBER && offset.abs().max_element() <= MAX_NUMBER) {
            let message =
                format!("moves or scales the picture out of range; allowed: up to {MAX_NUMBER:e}");
            return report.refuse(&place, message);
        }
        // In the file, v points upwards and v' = s v + o. With v downwards, the map is 1 − v' = s
        // (1 − v) + 1 − s − o.
        let moved = DVec2::new(offset.x, 1.0 - scale.y - offset.y);
        Some(Self {
            place,
            file: rest.replace('\\', "/"),
            folder,
            to_uv: DAffine2::from_scale_angle_translation(scale, 0.0, moved),
            wrap,
        })
    }
}

/// Splits a text into the first word and the rest.
fn cut(text: &str) -> (&str, &str) {
    let end = text.find(char::is_whitespace).unwrap_or(text.len());
    (&text[..end], text[end..].trim_start())
}

/// Reads the values of an option, at most the given number. Options with several values take only
/// numbers, since a file name follows.
fn arguments<'a>(mut rest: &'a str, most: usize, option: &str) -> (Vec<&'a str>, &'a str) {
    let mut values = Vec::new();
    let takes_words = most == 1;
    while values.len() < most {
        let (word, after) = cut(rest);
        let is_value = takes_words || word.parse::<f64>().is_ok();
        // The last word is the name of the file and not a value.
        if !is_value || after.is_empty() || option.is_empty() {
            break;
        }
        values.push(word);
        rest = after;
    }
    (values, rest)
}

fn pair(values: &[&str], or: f64) -> DVec2 {
    let number = |i: usize| values.get(i).and_then(|v| v.parse().ok()).unwrap_or(or);
    DVec2::new(number(0), number(1))
}
