//! Colours of a scene file. A run measures one number of each colour.

use super::allowed::told;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::borrow::Cow;
use std::fmt;

/// The number of each colour that is measured. Colours are linear sRGB.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = told("Luminance, Red, Green or Blue", "Red"))]
pub enum Color {
    /// The luminance, 0.212671 R + 0.715160 G + 0.072169 B, as in the `mono` variants of Mitsuba 3.9.
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
    /// All numbers of a colour by name, in the order of their definition.
    pub const ALL: [(&str, Self); 4] = [
        ("luminance", Self::Luminance),
        ("red", Self::Red),
        ("green", Self::Green),
        ("blue", Self::Blue),
    ];

    /// Checks for the luminance, which a scene file need not state.
    pub(super) fn is_luminance(&self) -> bool {
        *self == Self::Luminance
    }

    /// The name of the number.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::ALL[self as usize].0
    }

    /// Returns words that a line about a run ends with: the channel, or nothing for the luminance.
    #[must_use]
    pub fn suffix(self) -> String {
        match self {
            Self::Luminance => String::new(),
            channel => format!(", {}", channel.name()),
        }
    }

    /// The number of a colour.
    #[must_use]
    pub fn of(self, [red, green, blue]: [f64; 3]) -> f64 {
        match self {
            Self::Luminance => 0.212_671 * red + 0.715_160 * green + 0.072_169 * blue,
            Self::Red => red,
            Self::Green => green,
            Self::Blue => blue,
        }
    }
}

/// One number for all colours, or one number each for red, green and blue: `0.5` or
/// `(0.8, 0.5, 0.3)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ColorFile {
    /// The same number for red, green and blue.
    Grey(f64),
    /// Numbers for red, green and blue.
    Rgb([f64; 3]),
}

impl ColorFile {
    /// One number of the colour.
    #[must_use]
    pub fn number(self, color: Color) -> f64 {
        match self {
            Self::Grey(number) => number,
            Self::Rgb(rgb) => color.of(rgb),
        }
    }
}

impl From<f64> for ColorFile {
    fn from(number: f64) -> Self {
        Self::Grey(number)
    }
}

impl Serialize for ColorFile {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Grey(number) => number.serialize(serializer),
            Self::Rgb(rgb) => rgb.serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for ColorFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ColorVisitor)
    }
}

struct ColorVisitor;

impl<'de> Visitor<'de> for ColorVisitor {
    type Value = ColorFile;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number, or three numbers for red, green and blue")
    }

    fn visit_f64<E>(self, value: f64) -> Result<ColorFile, E> {
        Ok(value.into())
    }

    fn visit_u64<E>(self, value: u64) -> Result<ColorFile, E> {
        Ok((value as f64).into())
    }

    fn visit_i64<E>(self, value: i64) -> Result<ColorFile, E> {
        Ok((value as f64).into())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<ColorFile, A::Error> {
        let mut rgb = [0.0; 3];
        for (i, number) in rgb.iter_mut().enumerate() {
            let next = seq.next_element()?;
            *number = next.ok_or_else(|| A::Error::invalid_length(i, &self))?;
        }
        match seq.next_element::<f64>()? {
            None => Ok(ColorFile::Rgb(rgb)),
            Some(_) => Err(A::Error::invalid_length(4, &self)),
        }
    }
}

impl JsonSchema for ColorFile {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "ColorNumber".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "type": ["number", "array"],
            "items": { "type": "number" },
            "minItems": 3,
            "maxItems": 3,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_colour_is_one_number_or_three() {
        let ron = |text: &str| ron::from_str::<ColorFile>(text);
        let json = |text: &str| serde_json::from_str::<ColorFile>(text);
        let rgb = ColorFile::Rgb([0.5, 1.0, 2.0]);
        assert_eq!(ron("(0.5, 1, 2.0)").ok(), Some(rgb));
        assert_eq!(ron("[0.5, 1, 2.0]").ok(), Some(rgb));
        assert_eq!(json("[0.5, 1, 2]").ok(), Some(rgb));
        for text in ["3", "3.0", "-3"] {
            let number = ColorFile::Grey(text.parse().unwrap());
            assert_eq!(ron(text).ok(), Some(number));
            assert_eq!(json(text).ok(), Some(number));
        }
        for text in ["(1, 2)", "(1, 2, 3, 4)", "\"red\"", "(r: 1)", "()", "true"] {
            assert!(ron(text).is_err(), "{text}");
        }
        let written = serde_json::to_string(&[rgb, ColorFile::Grey(0.5)]).unwrap();
        assert_eq!(written, "[[0.5,1.0,2.0],0.5]");
        let luminance = 0.212_671 * 0.5 + 0.715_160 + 2.0 * 0.072_169;
        for ((name, color), wanted) in Color::ALL.into_iter().zip([luminance, 0.5, 1.0, 2.0]) {
            let off = rgb.number(color) - wanted;
            assert!(off.abs() < 1e-15, "{color:?} {off}"); // rounding
            assert_eq!(color.name(), name);
        }
    }
}
