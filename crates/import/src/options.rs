//! Options for reading a scene.

use std::path::PathBuf;

/// Options for reading a scene.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// The folder that must contain all files after links are followed; `None` stands for the scene
    /// file's own folder.
    pub root: Option<PathBuf>,
    /// The conversion of colours to numbers.
    pub color: Color,
    /// Values of Mitsuba's `$parameters`, which override the values in the file.
    pub set: Vec<(String, String)>,
}

/// The conversion of a colour to one number; worlds are monochrome.
///
/// Colours are linear sRGB; levels of 8-bit pictures are linearised first. The luminance, 0.212671
/// R + 0.715160 G + 0.072169 B, matches the `mono` variants of Mitsuba 3.9, and the channels match
/// its `rgb` variants.
///
/// A sampled spectrum becomes a colour as in Mitsuba. The spectrum is interpolated linearly at 1000
/// wavelengths from 360 to 830 nm, and is zero beyond its ends. The 1000 interpolated values are
/// weighted with the CIE 1931 matching functions and converted to linear sRGB. Reflectances are
/// also weighted with D65 and clamped to 0 to 1. Radiances and indices of refraction are clamped to
/// at least 0. A spectrum that is given by one number becomes this number. For lights, each channel
/// is multiplied by the same channel of the equal-energy white, (1.2048, 0.9483, 0.9089).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Color {
    /// The luminance of linear sRGB.
    #[default]
    Luminance,
    /// The red channel.
    Red,
    /// The green channel.
    Green,
    /// The blue channel.
    Blue,
}

impl Color {
    /// All conversions by name.
    pub const ALL: [(&str, Self); 4] = [
        ("luminance", Self::Luminance),
        ("red", Self::Red),
        ("green", Self::Green),
        ("blue", Self::Blue),
    ];

    /// Converts a colour in linear sRGB to a number.
    pub(crate) fn of(self, [red, green, blue]: [f64; 3]) -> f64 {
        match self {
            Self::Luminance => 0.212_671 * red + 0.715_160 * green + 0.072_169 * blue,
            Self::Red => red,
            Self::Green => green,
            Self::Blue => blue,
        }
    }
}
