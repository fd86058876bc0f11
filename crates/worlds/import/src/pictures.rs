//! Pictures of any scene format: one number for each pixel.

mod bmp;
mod hdr;
mod jpeg;
mod pfm;
mod size;

use crate::range::MAX_NUMBER;
use crate::{Color, files::Files};
use etendue_field::Raster;
use etendue_scene::{Channels, Fault, Samples, read_channels};
use size::invalid;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A cache of pictures, from which each picture is read only once.
#[derive(Debug, Default)]
pub(crate) struct Pictures {
    /// Pictures by path and by curve, in words.
    known: HashMap<(PathBuf, String), Result<Arc<Raster>, String>>,
}

/// How the levels of a picture represent light.
#[derive(Clone, Copy, Debug)]
pub(crate) enum TransferCurve {
    /// The sRGB curve.
    Srgb,
    /// Levels are proportional to light.
    Linear,
    /// The amount of light is the level raised to the given power.
    Gamma(f64),
}

impl Pictures {
    /// Reads the picture at a path, with the given curve of levels.
    pub(crate) fn read(
        &mut self,
        files: &Files,
        path: &Path,
        color: Color,
        curve: TransferCurve,
    ) -> Result<Arc<Raster>, String> {
        let key = (path.to_owned(), format!("{curve:?}"));
        if let Some(known) = self.known.get(&key) {
            return known.clone();
        }
        let read = read(files, path, color, curve).map(Arc::new);
        self.known.insert(key, read.clone());
        read
    }
}

fn read(files: &Files, path: &Path, color: Color, curve: TransferCurve) -> Result<Raster, String> {
    let bytes = files.read(path)?;
    let channels = decode(path, &bytes, files)?;
    if let Samples::Numbers(numbers) = &channels.samples
        && !numbers.iter().all(|v| f64::from(v.abs()) <= MAX_NUMBER)
    {
        return Err(format!(
            "has pixels out of range; allowed: up to {MAX_NUMBER:e}"
        ));
    }
    let curve = |level: f64| match curve {
        TransferCurve::Srgb => linear(level),
        TransferCurve::Gamma(exponent) => libm::pow(level, exponent),
        TransferCurve::Linear => level,
    };
    counted(files, weighted(&channels, color, None, curve))
}

/// One number for each pixel. Its levels are converted by `light`, and multiplied by the
/// factors of the channels, if there are any.
pub(crate) fn weighted(
    channels: &Channels,
    color: Color,
    factors: Option<[f64; 3]>,
    light: impl Fn(f64) -> f64,
) -> Result<Raster, Fault> {
    let (is_grey, white) = (channels.is_grey(), factors.map_or(1.0, |of| color.of(of)));
    let factors = factors.unwrap_or([1.0; 3]);
    // The value of a grey pixel is used directly, because a luminance computed from three equal
    // values would have a rounding error.
    channels.raster(light, |rgb| match is_grey {
        true => rgb[0] * white,
        false => color.of([0, 1, 2].map(|i| factors[i] * rgb[i])),
    })
}

/// Counts the memory of a raster that is kept.
pub(crate) fn counted(files: &Files, raster: Result<Raster, Fault>) -> Result<Raster, String> {
    let raster = raster.map_err(|fault| fault.to_string())?;
    files.spend(size_of_val(raster.values()) as u64)?;
    Ok(raster)
}

/// Decodes the channels of a picture; the extension of `path` determines the format. The
/// picture and one number of each pixel must fit into the memory that is left.
pub(crate) fn decode(path: &Path, bytes: &[u8], files: &Files) -> Result<Channels, String> {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    match extension.to_ascii_lowercase().as_str() {
        "bmp" => bmp::read(bytes, files),
        "jpg" | "jpeg" => jpeg::read(bytes, files),
        "hdr" | "rgbe" => hdr::read(bytes, files),
        "pfm" => pfm::read(bytes, files),
        "png" | "exr" => {
            read_channels(path, bytes, files.left()).map_err(|fault| invalid(fault, files))
        }
        other => Err(format!(
            "has extension {other:?}; allowed: bmp, exr, hdr, jpg, pfm, png"
        )),
    }
}

/// Converts an sRGB level to linear light (IEC 61966-2-1).
pub(crate) fn linear(level: f64) -> f64 {
    if level <= 0.04045 {
        level / 12.92
    } else {
        libm::pow((level + 0.055) / 1.055, 2.4)
    }
}
