//! Options for reading a scene.

use etendue_scene::Color;
use std::path::PathBuf;

/// Options for reading a scene.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// The folder that must contain all files after links are followed; `None` stands for the scene
    /// file's own folder.
    pub root: Option<PathBuf>,
    /// The number of each colour; worlds are monochrome.
    ///
    /// Levels of 8-bit pictures are linearised first. The channels match the `rgb` variants of
    /// Mitsuba 3.9.
    ///
    /// A sampled spectrum becomes a colour as in Mitsuba. The spectrum is interpolated linearly at
    /// 1000 wavelengths from 360 to 830 nm, and is zero beyond its ends. The 1000 interpolated
    /// values are weighted with the CIE 1931 matching functions and converted to linear sRGB.
    /// Reflectances are also weighted with D65 and clamped to 0 to 1. Radiances and indices of
    /// refraction are clamped to at least 0. A spectrum that is given by one number becomes this
    /// number. For lights, each channel is multiplied by the same channel of the equal-energy
    /// white, (1.2048, 0.9483, 0.9089).
    pub color: Color,
    /// The memory that the files of a scene and their content may take, bytes; at most 4 GiB, which
    /// `None` stands for.
    pub memory: Option<u64>,
    /// Values of Mitsuba's `$parameters`, which override the values in the file.
    pub set: Vec<(String, String)>,
}
