//! How a scene is read.

use std::path::PathBuf;

/// How a scene is read.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// The folder that no file may lie out of, links followed; the scene file's own if `None`.
    pub root: Option<PathBuf>,
    /// The number that a colour becomes.
    pub color: Color,
    /// Values of Mitsuba's `$parameters`, before those of the file.
    pub set: Vec<(String, String)>,
}

/// The number that a colour becomes: light is one number in a world.
///
/// Colours are linear sRGB; levels of 8-bit pictures are linearised before. Luminance is 0.212671 R + 0.715160 G + 0.072169 B. It gives what the
/// `mono` variants of Mitsuba 3.9 give, and the channels what its `rgb` variants give.
///
/// A sampled spectrum becomes a colour as there: it is interpolated linearly at 1000 wavelengths from 360 to 830 nm and zero beyond its ends, weighed
/// with the CIE 1931 matching functions, and made linear sRGB. Reflectances are weighed with D65 too and brought into 0 to 1; radiances and indices of
/// refraction are brought above 0. A spectrum of one number stays that number; but for the channels of a light it is the colour of the white with
/// equal power, (1.2048, 0.9483, 0.9089).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Color {
    /// The luminance of linear sRGB.
    #[default]
    Luminance,
    /// The first channel.
    Red,
    /// The second channel.
    Green,
    /// The third channel.
    Blue,
}

impl Color {
    /// Each by its name.
    pub const ALL: [(&str, Self); 4] = [
        ("luminance", Self::Luminance),
        ("red", Self::Red),
        ("green", Self::Green),
        ("blue", Self::Blue),
    ];

    /// The number of a colour in linear sRGB.
    pub(crate) fn of(self, [red, green, blue]: [f64; 3]) -> f64 {
        match self {
            Self::Luminance => 0.212_671 * red + 0.715_160 * green + 0.072_169 * blue,
            Self::Red => red,
            Self::Green => green,
            Self::Blue => blue,
        }
    }
}
