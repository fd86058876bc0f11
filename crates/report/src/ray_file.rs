//! Describes the content of a ray file in words.

use etendue_field::tidy;
use etendue_rayfile::mcpl::{McplFile, PHOTON};
use etendue_rayfile::tm25::{Tm25File, Tm25Header};
use etendue_rayfile::{RayFile, RaySet, Wavelengths};
use etendue_scene::shown;

/// The maximum number of characters that are shown of each text, and the maximum number of texts
/// that are shown.
const LONGEST: usize = 200;
const MOST_TEXTS: usize = 20;

/// A description of the content of a ray file, line by line. `packed` states whether the
/// file is in gzip.
#[must_use]
pub fn description(file: &RayFile, packed: bool) -> Vec<String> {
    let set = file.rays();
    let mut rows = vec![
        ("format", format_line(file, packed)),
        ("rays", set.len().to_string()),
        ("power", power(file, &set)),
        ("positions", bounds(&set)),
        ("wavelengths", wavelengths(&set)),
    ];
    match file {
        RayFile::Tm25(file) => rows.extend(of_tm25(file)),
        RayFile::Mcpl(file) => rows.extend(of_mcpl(file)),
        RayFile::Npy(_) => {}
    }
    let lengths = rows.iter().map(|(name, _)| name.chars().count());
    let width = lengths.max().unwrap_or(0);
    rows.into_iter()
        .map(|(name, value)| format!("{name:<width$}  {value}"))
        .collect()
}

fn format_line(file: &RayFile, packed: bool) -> String {
    let name = match file {
        RayFile::Tm25(file) => format!("IES TM-25, version {}; mm, nm, f32", file.header().version),
        RayFile::Mcpl(file) => {
            let header = file.header();
            let ends = if header.little_endian {
                "little"
            } else {
                "big"
            };
            let bits = if header.single_precision { 32 } else { 64 };
            format!(
                "MCPL-{}, {ends}-endian; cm, MeV, ms, f{bits}",
                header.version
            )
        }
        RayFile::Npy(_) => "NPY; m, f64".to_owned(),
    };
    let packed = if packed { ", in gzip" } else { "" };
    format!("{name}{packed}")
}

fn power(file: &RayFile, set: &RaySet) -> String {
    let total = format!("{} {}", tidy(set.total_power()), set.unit.symbol());
    let RayFile::Tm25(file) = file else {
        return total;
    };
    let stated = |flux: f32, unit: &str| {
        (!flux.is_nan()).then(|| format!("{} {unit}", tidy(f64::from(flux))))
    };
    let Tm25Header {
        radiant_flux,
        luminous_flux,
        ..
    } = *file.header();
    let stated = [stated(radiant_flux, "W"), stated(luminous_flux, "lm")];
    let stated: Vec<String> = stated.into_iter().flatten().collect();
    if stated.is_empty() {
        total
    } else {
        format!("{total}; the header states {}", stated.join(", "))
    }
}

fn bounds(set: &RaySet) -> String {
    let Some([low, high]) = set.bounds() else {
        return "none".to_owned();
    };
    let axis = |i: usize| {
        let [low, high] = [low[i], high[i]].map(tidy);
        format!("{} {low} to {high}", ["x", "y", "z"][i])
    };
    format!("{} m", [0, 1, 2].map(axis).join(", "))
}

fn wavelengths(set: &RaySet) -> String {
    let range = |values: &mut dyn Iterator<Item = f64>| {
        let [low, high] = values
            .filter(|w| !w.is_nan())
            .fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], w| {
                [low.min(w), high.max(w)]
            });
        format!("{} to {} nm", tidy(1e9 * low), tidy(1e9 * high))
    };
    match &set.wavelengths {
        Wavelengths::Unknown => "not stated".to_owned(),
        Wavelengths::One(wavelength) => format!("{} nm", tidy(1e9 * wavelength)),
        Wavelengths::Each(each) => {
            let unknown = each.iter().filter(|w| w.is_nan()).count();
            let rest = match unknown {
                0 => String::new(),
                n => format!("; {n} rays have no wavelength"),
            };
            format!(
                "{}, one for each ray{rest}",
                range(&mut each.iter().copied())
            )
        }
        Wavelengths::Spectrum(table) => {
            let range = range(&mut table.iter().map(|[wavelength, _]| *wavelength));
            format!("{range}, one spectrum of {} rows for all rays", table.len())
        }
    }
}

fn of_tm25(file: &Tm25File) -> Vec<(&'static str, String)> {
    let header = file.header();
    let date: Vec<u8> = header.date.into_iter().take_while(|b| *b != 0).collect();
    let made = ["simulated", "measured"].get(usize::try_from(header.creation_method).unwrap_or(2));
    let made = format!("{} {}", made.unwrap_or(&"unknown"), text(&date));
    let mut rows = vec![("made", made.trim_end().to_owned())];
    let texts = Tm25Header::TEXTS.into_iter().zip(&header.texts);
    let texts = texts.chain([("additional text", &header.additional_text)]);
    for (name, content) in texts.filter(|(_, content)| !content.is_empty()) {
        rows.push((name, text(content.as_bytes())));
    }
    if !header.extra_columns.is_empty() {
        let names = header.extra_columns.iter().take(MOST_TEXTS);
        let names = names.map(|name| text(name.as_bytes()));
        rows.push(("more columns", names.collect::<Vec<_>>().join(", ")));
    }
    rows.extend(file.notes().iter().map(|note| ("note", note.clone())));
    rows
}

fn of_mcpl(file: &McplFile) -> Vec<(&'static str, String)> {
    let header = file.header();
    let photons = file.particles().filter(|p| p.pdg == PHOTON).count();
    let mut rows = vec![
        ("photons", format!("{photons} of {} particles", file.len())),
        ("source", text(&header.source)),
    ];
    for sum in header.stat_sums().into_iter().take(MOST_TEXTS) {
        let value = sum.value.map_or("not known".to_owned(), |v| v.to_string());
        rows.push(("sum", format!("{} = {value}", sum.key)));
    }
    let is_comment = |c: &&Vec<u8>| !c.starts_with(b"stat:sum:");
    let comments = header.comments.iter().filter(is_comment);
    rows.extend(comments.take(MOST_TEXTS).map(|c| ("comment", text(c))));
    for (key, data) in header.blobs.iter().take(MOST_TEXTS) {
        rows.push(("blob", format!("{}, {} bytes", text(key), data.len())));
    }
    for (there, what) in [
        (header.polarisation, "polarisation"),
        (header.user_flags, "user flags"),
        (file.particles().any(|p| p.time_ms.abs() > 0.0), "times"),
    ] {
        if there {
            rows.push(("also", what.to_owned()));
        }
    }
    rows
}

/// A text from the file, on one line.
fn text(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(bytes).replace('\n', " ");
    shown(&text, LONGEST)
}
