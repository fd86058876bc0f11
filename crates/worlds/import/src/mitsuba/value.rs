//! Parsing of numbers and lists in Mitsuba's syntax.

use super::object::Value;
use crate::range::in_range;
use crate::report::quoted;
use glam::DVec3;
use std::rc::Rc;

/// Parses a number in the allowed range; `Err` describes a fault.
pub(super) fn number(text: &str) -> Result<f64, String> {
    let parsed: Option<f64> = text.trim().parse().ok();
    match parsed {
        Some(value) if value.is_finite() => in_range(value),
        _ => Err(format!("{} is not a finite number", quoted(text))),
    }
}

/// Parses numbers that are separated by commas and white space.
pub(super) fn numbers(text: &str) -> Result<Vec<f64>, String> {
    words(text).map(number).collect()
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    let is_between = |c: char| c == ',' || c.is_ascii_whitespace();
    text.split(is_between).filter(|word| !word.is_empty())
}

pub(super) fn whole(text: &str) -> Result<i64, String> {
    let parsed = text.trim().parse();
    parsed.map_err(|_| format!("{} is not an integer", quoted(text)))
}

pub(super) fn truth(text: &str) -> Result<bool, String> {
    match text.to_ascii_lowercase().as_str() {
        "true" => Ok(true),
        "false" => Ok(false),
        _ => Err(format!("{} is neither true nor false", quoted(text))),
    }
}

/// Parses three numbers.
pub(super) fn vector(text: &str) -> Result<DVec3, String> {
    match numbers(text)?[..] {
        [x, y, z] => Ok(DVec3::new(x, y, z)),
        _ => Err(format!("{} is not three numbers", quoted(text))),
    }
}

/// Parses three numbers, or one number that is used for all three.
pub(super) fn triple(text: &str) -> Result<[f64; 3], String> {
    match numbers(text)?[..] {
        [value] => Ok([value; 3]),
        [x, y, z] => Ok([x, y, z]),
        _ => Err(format!("{} is neither one number nor three", quoted(text))),
    }
}

/// Parses a spectrum: one number, or pairs such as `400:0.3`.
pub(super) fn spectrum(text: &str) -> Result<Value, String> {
    let all: Vec<&str> = words(text).collect();
    if let [single] = all[..]
        && !single.contains(':')
    {
        return Ok(Value::Uniform(number(single)?));
    }
    let pairs = all.into_iter().map(|word| {
        let (wavelength, value) = word
            .split_once(':')
            .ok_or_else(|| format!("{} is not a pair WAVELENGTH:VALUE", quoted(word)))?;
        Ok([number(wavelength)?, number(value)?])
    });
    sampled(pairs.collect::<Result<_, String>>()?)
}

/// Parses an .spd file: a wavelength and a value per line.
pub(super) fn spectrum_file(text: &str) -> Result<Value, String> {
    let mut pairs = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default();
        match numbers(line).map_err(|error| format!("line {}: {error}", i + 1))?[..] {
            [] => {}
            [wavelength, value] => pairs.push([wavelength, value]),
            _ => return Err(format!("line {} is not a wavelength and a value", i + 1)),
        }
    }
    sampled(pairs)
}

fn sampled(pairs: Vec<[f64; 2]>) -> Result<Value, String> {
    if pairs.len() < 2 {
        return Err("a sampled spectrum has at least two wavelengths".to_owned());
    }
    if !pairs.is_sorted_by(|a, b| a[0] < b[0]) {
        return Err("wavelengths are not in rising order".to_owned());
    }
    Ok(Value::Spectrum(Rc::from(pairs)))
}
