//! Parsing of MTL files, statement by statement, into entries with pictures.

use crate::range::MAX_NUMBER;
use crate::report::{Report, SourcePlace, quoted};
use crate::spectrum::from_xyz;
use etendue_world::{Texture, Wrap};
use glam::{DAffine2, DVec2};
use std::collections::HashMap;
use std::collections::hash_map::Entry as Slot;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// The highest illumination model.
const MOST_ILLUM: f64 = 10.0;

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

struct MtlStatement<'a> {
    word: &'a str,
    rest: &'a str,
    place: SourcePlace,
    report: &'a Report,
}

impl MtlStatement<'_> {
    /// Applies a statement, and returns whether the statement is known.
    fn apply(&self, entry: &mut MtlEntry, folder: &Path) -> bool {
        match self.word.to_ascii_lowercase().as_str() {
            "kd" => entry.kd = self.color(1.0).or(entry.kd),
            "ks" => entry.ks = self.color(1.0).or(entry.ks),
            "ke" => entry.ke = self.color(MAX_NUMBER).or(entry.ke),
            "tf" => entry.tf = self.color(1.0).or(entry.tf),
            "ns" => entry.ns = self.number(0.0, MAX_NUMBER).or(entry.ns),
            "ni" => entry.ni = self.number(0.001, 10.0).or(entry.ni),
            "d" => entry.d = self.opacity().or(entry.d),
            "tr" => entry.d = self.number(0.0, 1.0).map(|tr| 1.0 - tr).or(entry.d),
            "illum" => {
                let illum = self.number(0.0, MOST_ILLUM);
                let whole = (0..=10).find(|n| illum == Some(f64::from(*n)));
                if illum.is_some() && whole.is_none() {
                    self.refuse("a whole number from 0 to 10");
                }
                entry.illum = whole.or(entry.illum);
            }
            // The pictures named by bump, normal and displacement statements would change normals
            // or displace the surface.
            "bump" | "map_bump" | "norm" | "disp" => {
                let word = self.word;
                let message = format!("{word} is not supported: normals are those of the shape");
                self.report.cause(&self.place, message);
            }
            "map_kd" => entry.map_kd = self.map(folder).or(entry.map_kd.take()),
            "map_ke" => entry.map_ke = self.map(folder).or(entry.map_ke.take()),
            "map_d" => entry.map_d = self.map(folder).or(entry.map_d.take()),
            _ => return false,
        }
        true
    }

    fn refuse(&self, allowed: &str) {
        let message = format!("{} is {}; allowed: {allowed}", self.word, quoted(self.rest));
        self.report.cause(&self.place, message);
    }

    fn map(&self, folder: &Path) -> Option<MtlMap> {
        let place = self.place.clone();
        MtlMap::read(self.rest, place, folder.to_owned(), self.report)
    }

    fn opacity(&self) -> Option<f64> {
        let Some(after) = self.rest.strip_prefix("-halo") else {
            return self.number(0.0, 1.0);
        };
        self.report.note(&self.place, "-halo is left out");
        let inner = MtlStatement {
            rest: after.trim(),
            place: self.place.clone(),
            ..*self
        };
        inner.number(0.0, 1.0)
    }

    fn number(&self, low: f64, high: f64) -> Option<f64> {
        let parsed: Option<f64> = self.rest.parse().ok();
        let found = parsed.filter(|v| (low..=high).contains(v));
        if found.is_none() {
            self.refuse(&format!("a number from {low} to {high}"));
        }
        found
    }

    /// Parses a colour: one number for all channels, three numbers, or `xyz` and three CIE values.
    fn color(&self, most: f64) -> Option<[f64; 3]> {
        let is_xyz = self.rest.starts_with("xyz");
        let text = self.rest.strip_prefix("xyz").unwrap_or(self.rest);
        let words: Vec<&str> = text.split_whitespace().take(4).collect();
        let numbers: Option<Vec<f64>> = words.iter().map(|word| word.parse().ok()).collect();
        let color = match numbers.as_deref() {
            Some([x]) => Some([*x; 3]),
            Some([x, y, z]) => Some([*x, *y, *z]),
            _ => None,
        };
        let color = color.map(|color| if is_xyz { from_xyz(color) } else { color });
        let is_sound = |v: &f64| (0.0..=most).contains(v);
        let found = color.filter(|color| color.iter().all(is_sound));
        if found.is_none() {
            self.refuse(&format!("one number or three, from 0 to {most}"));
        }
        found
    }
}

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

/// Reads the materials of a file. Materials that are already known are kept.
pub(super) fn read(
    text: &str,
    name: &str,
    folder: &Path,
    report: &Report,
    entries: &mut HashMap<String, MtlEntry>,
) {
    let name: Rc<str> = name.into();
    let mut unknown: Vec<(SourcePlace, String, usize)> = Vec::new();
    let mut open: Option<(String, MtlEntry)> = None;
    for (i, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default().trim();
        let end = line.find(char::is_whitespace).unwrap_or(line.len());
        let (word, rest) = (&line[..end], line[end..].trim());
        let place = SourcePlace::at(&name, i + 1, 1);
        if word.is_empty() {
            continue;
        }
        if word.eq_ignore_ascii_case("newmtl") {
            close(open.take(), report, entries);
            let entry = MtlEntry {
                place,
                ..MtlEntry::default()
            };
            open = Some((rest.to_owned(), entry));
            continue;
        }
        let Some((_, entry)) = &mut open else {
            let word = quoted(word);
            let message = format!("{word} is left out, because it stands before the first newmtl");
            report.note(&place, message);
            continue;
        };
        let statement = MtlStatement {
            word,
            rest,
            place,
            report,
        };
        if !statement.apply(entry, folder) {
            let known = unknown.iter_mut().find(|(_, known, _)| known == word);
            match known {
                Some((_, _, count)) => *count += 1,
                None => unknown.push((statement.place, word.to_owned(), 1)),
            }
        }
    }
    close(open, report, entries);
    for (place, word, count) in unknown {
        report.note(&place, left_out(&quoted(&word), count));
    }
}

/// The message that a statement is left out, with the number of occurrences of the
/// statement.
pub(super) fn left_out(word: &str, count: usize) -> String {
    match count {
        1 => format!("{word} is left out"),
        _ => format!("{word} is left out, {count} times"),
    }
}

fn close(
    open: Option<(String, MtlEntry)>,
    report: &Report,
    entries: &mut HashMap<String, MtlEntry>,
) {
    let Some((name, entry)) = open else {
        return;
    };
    match entries.entry(name) {
        Slot::Occupied(known) => {
            let name = quoted(known.key());
            let message = format!("material {name} is given twice: the first one is used");
            report.note(&entry.place, message);
        }
        Slot::Vacant(slot) => {
            slot.insert(entry);
        }
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
