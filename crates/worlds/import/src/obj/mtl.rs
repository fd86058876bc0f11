//! Parsing of MTL files, statement by statement.

use super::entry::{MtlEntry, MtlMap};
use crate::range::MAX_NUMBER;
use crate::report::{Report, SourcePlace, quoted};
use crate::spectrum::from_xyz;
use std::collections::HashMap;
use std::collections::hash_map::Entry as Slot;
use std::path::Path;

/// The highest illumination model.
const MOST_ILLUM: f64 = 10.0;

/// Reads the materials of a file. Materials that are already known are kept.
pub(super) fn read(
    text: &str,
    name: &str,
    folder: &Path,
    report: &Report,
    entries: &mut HashMap<String, MtlEntry>,
) {
    let mut unknown: Vec<(SourcePlace, String, usize)> = Vec::new();
    let mut open: Option<(String, MtlEntry)> = None;
    for (i, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default().trim();
        let end = line.find(char::is_whitespace).unwrap_or(line.len());
        let (word, rest) = (&line[..end], line[end..].trim());
        let place = SourcePlace {
            file: name.into(),
            line: i + 1,
            column: 1,
        };
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
            report.note(
                &place,
                format!(
                    "{} is left out, because it stands before the first newmtl",
                    quoted(word)
                ),
            );
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

/// Returns the message that a statement is left out, with the number of occurrences of the
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
            let message = format!(
                "material {} is given twice: the first one is used",
                quoted(known.key())
            );
            report.note(&entry.place, message);
        }
        Slot::Vacant(slot) => {
            slot.insert(entry);
        }
    }
}

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
                let message = format!(
                    "{} is not supported: normals are those of the shape",
                    self.word
                );
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
        MtlMap::read(
            self.rest,
            self.place.clone(),
            folder.to_owned(),
            self.report,
        )
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
