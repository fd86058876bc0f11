//! Colours and spectra of parameters, as numbers.
//!
//! The colours of named spectra were computed from pbrt's tables of n and k by wavelength, by the
//! rule at [`Color`](crate::Color), with D65 as the weight. The colours of metals differ from the
//! colours in Mitsuba for two reasons. Mitsuba weights its tables with the equal-energy white, and
//! the tables of pbrt and Mitsuba contain different numbers.

use super::entity::{CauseGiven, Entity, ParameterValues, Read};
use super::reader::PbrtReader;
use super::token::number;
use crate::Color;
use crate::range::in_range;
use crate::report::quoted;
use crate::spectrum::{Role, rgb};

/// The second radiation constant of Planck's law, in nm K.
const PLANCK: f64 = 1.438_776_877e7;

/// The temperature of the CIE's illuminant A, K.
const TUNGSTEN: f64 = 2855.5;

#[rustfmt::skip]
const NAMED: &[(&str, [f64; 3])] = &[
    ("glass-BAF10", [1.664422, 1.671626, 1.684619]),
    ("glass-BK7", [1.513015, 1.517091, 1.524163]),
    ("glass-F10", [1.719582, 1.732508, 1.756502]),
    ("glass-F11", [1.774714, 1.790022, 1.819554]),
    ("glass-F5", [1.665355, 1.675851, 1.69556]),
    ("glass-FK51A", [1.483435, 1.486313, 1.491308]),
    ("glass-LASF9", [1.841193, 1.854552, 1.879446]),
    ("metal-Ag-eta", [0.1283473, 0.1233954, 0.1507139]),
    ("metal-Ag-k", [4.060675, 3.282513, 2.388917]),
    ("metal-Al-eta", [1.405952, 0.9256124, 0.5833764]),
    ("metal-Al-k", [7.732359, 6.595033, 5.353976]),
    ("metal-Au-eta", [0.07987052, 0.4046524, 1.558968]),
    ("metal-Au-k", [3.386746, 2.500706, 1.768912]),
    ("metal-Cu-eta", [0.1050559, 0.9768189, 1.203228]),
    ("metal-Cu-k", [3.270163, 2.589603, 2.366343]),
    ("metal-CuZn-eta", [0.4179793, 0.5195058, 1.121686]),
    ("metal-CuZn-k", [3.663866, 2.677607, 1.769291]),
    ("metal-MgO-eta", [1.731918, 1.738989, 1.751447]),
    ("metal-MgO-k", [0.0; 3]),
    ("metal-TiO2-eta", [2.857479, 2.953201, 3.181716]),
    ("metal-TiO2-k", [0.00009097303, 0.0, 0.0005662864]),
];

/// A spectrum as it is given in a file.
enum PbrtSpectrum {
    Rgb([f64; 3]),
    /// Temperature in kelvin.
    Blackbody(f64),
    /// Pairs of a wavelength, nm, and a value.
    Sampled(Vec<[f64; 2]>),
    Named(String),
}

impl PbrtReader<'_> {
    /// The number for a colour or spectrum, or `None` if the parameter is missing.
    pub(super) fn number_of(
        &self,
        entity: &Entity<'_>,
        name: &str,
        role: Role,
    ) -> Read<Option<f64>> {
        let Some(spectrum) = self.spectrum(entity, name)? else {
            return Ok(None);
        };
        let fault = |what: &str| entity.fault(name, format!("{name} {what}"));
        let color = match (role, spectrum) {
            (Role::Emission, spectrum) => self.light_color(spectrum, &fault)?,
            (Role::Reflectance, PbrtSpectrum::Rgb(rgb)) if rgb.iter().any(|v| *v > 1.0) => {
                return Err(fault("is above 1; allowed: 0 to 1"));
            }
            (_, PbrtSpectrum::Rgb(rgb)) => rgb,
            (role, PbrtSpectrum::Sampled(samples)) => rgb(&samples, role),
            (_, PbrtSpectrum::Named(name)) if let Some(rgb) = named_index(&name) => rgb,
            (_, PbrtSpectrum::Named(_) | PbrtSpectrum::Blackbody(_)) => {
                return Err(fault(
                    "is the spectrum of a light; allowed: rgb, pairs of a wavelength and a value, or the name of a glass or metal",
                ));
            }
        };
        Ok(Some(self.color.of(color)))
    }

    /// The colour of a light. A spectrum is normalised to luminance 1, and a colour keeps
    /// the luminance of its numbers.
    fn light_color(
        &self,
        spectrum: PbrtSpectrum,
        fault: &impl Fn(&str) -> CauseGiven,
    ) -> Read<[f64; 3]> {
        let samples = match spectrum {
            PbrtSpectrum::Rgb(rgb) => return Ok(rgb),
            PbrtSpectrum::Blackbody(kelvin) if kelvin > 0.0 => blackbody(kelvin),
            PbrtSpectrum::Blackbody(_) => return Err(fault("is not a temperature above 0")),
            PbrtSpectrum::Sampled(samples) => samples,
            PbrtSpectrum::Named(name) => match name.as_str() {
                "stdillum-D65" => return Ok([1.0; 3]),
                "stdillum-A" => blackbody(TUNGSTEN),
                // For a conversion to luminance, only the luminance of the illuminant is needed,
                // and this luminance is 1.
                _ if is_illuminant(&name) && self.color == Color::Luminance => {
                    return Ok([1.0; 3]);
                }
                _ if is_illuminant(&name) => {
                    return Err(fault(
                        "is a standard illuminant whose colour is not known; allowed only if colours are converted to luminance",
                    ));
                }
                _ => {
                    return Err(fault(
                        "is an index of refraction; allowed: rgb, blackbody, pairs of a wavelength and a value, or the name of a standard illuminant",
                    ));
                }
            },
        };
        let color = rgb(&samples, Role::Emission);
        let luminance = Color::Luminance.of(color);
        match luminance > 0.0 {
            true => Ok(color.map(|v| v / luminance)),
            false => Err(fault("has no luminance")),
        }
    }

    fn spectrum(&self, entity: &Entity<'_>, name: &str) -> Read<Option<PbrtSpectrum>> {
        let Some(parameter) = entity.find(name) else {
            return Ok(None);
        };
        let fault = |message: String| entity.fault(name, message);
        let found = match (parameter.kind, &parameter.values) {
            (_, ParameterValues::Broken) => return Err(CauseGiven),
            ("rgb", ParameterValues::Numbers(all)) => match all[..] {
                [r, g, b] if r.min(g).min(b) >= 0.0 => PbrtSpectrum::Rgb([r, g, b]),
                [_, _, _] => return Err(fault(format!("{name} is below 0"))),
                _ => return Err(fault(format!("{name} is not one colour"))),
            },
            ("blackbody", ParameterValues::Numbers(all)) if all.len() == 1 => {
                PbrtSpectrum::Blackbody(all[0])
            }
            ("spectrum", ParameterValues::Numbers(all)) => PbrtSpectrum::Sampled(
                sampled(all).map_err(|error| fault(format!("{name}: {error}")))?,
            ),
            ("spectrum", ParameterValues::Texts(all)) if all.len() == 1 => {
                self.named_spectrum(&all[0]).map_err(fault)?
            }
            (kind, _) => {
                let message =
                    format!("{name} is of type {kind}; allowed: one rgb, spectrum or blackbody");
                return Err(fault(message));
            }
        };
        Ok(Some(found))
    }

    /// Returns a spectrum that pbrt knows by name, or reads a spectrum from a file of pairs.
    fn named_spectrum(&self, name: &str) -> Result<PbrtSpectrum, String> {
        if named_index(name).is_some() || is_illuminant(name) {
            return Ok(PbrtSpectrum::Named(name.to_owned()));
        }
        let unread = |error: String| format!("spectrum {} {error}", quoted(name));
        let path = self.find(name).map_err(unread)?;
        let text = super::build::read(self.files, &path).map_err(unread)?;
        let lines = text.lines().map(|line| line.split('#').next());
        let words = lines.flat_map(|line| line.unwrap_or_default().split_whitespace());
        let numbers: Result<Vec<f64>, String> = words.map(|word| in_range(number(word)?)).collect();
        let samples = numbers.and_then(|numbers| sampled(&numbers));
        Ok(PbrtSpectrum::Sampled(
            samples.map_err(|e| unread(format!(": {e}")))?,
        ))
    }
}

fn sampled(numbers: &[f64]) -> Result<Vec<[f64; 2]>, String> {
    let pairs: Vec<[f64; 2]> = numbers.chunks_exact(2).map(|p| [p[0], p[1]]).collect();
    if pairs.len() < 2 || !numbers.len().is_multiple_of(2) {
        return Err("allowed: at least two pairs of a wavelength and a value".to_owned());
    }
    match pairs.is_sorted_by(|a, b| a[0] < b[0]) {
        true => Ok(pairs),
        false => Err("wavelengths are not in rising order".to_owned()),
    }
}

/// The spectrum of Planck's law, normalised to a maximum of 1.
fn blackbody(kelvin: f64) -> Vec<[f64; 2]> {
    // The logarithms are taken relative to 560 nm, to avoid overflow in the ratio.
    let log = |nm: f64| {
        let x = PLANCK / (nm * kelvin);
        -5.0 * libm::log(nm) - x - libm::log1p(-libm::exp(-x))
    };
    let all = (0..=94).map(|i| 360.0 + 5.0 * f64::from(i));
    let most = all.clone().map(log).fold(f64::NEG_INFINITY, f64::max);
    all.map(|nm| [nm, libm::exp(log(nm) - most)]).collect()
}

/// Returns red, green and blue of the spectrum of a glass or metal, or `None` for an unknown name.
pub(super) fn named_index(name: &str) -> Option<[f64; 3]> {
    let found = NAMED.iter().find(|(known, _)| *known == name)?;
    Some(found.1)
}

/// Checks whether a name denotes a standard illuminant.
fn is_illuminant(name: &str) -> bool {
    let Some(which) = name.strip_prefix("stdillum-") else {
        return false;
    };
    let fluorescent = which.strip_prefix('F').and_then(|n| n.parse::<u8>().ok());
    matches!(which, "A" | "D50" | "D65") || fluorescent.is_some_and(|n| (1..=12).contains(&n))
}
