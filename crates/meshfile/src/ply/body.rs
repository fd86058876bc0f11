//! Reads the data of a PLY file.

use super::header::{Encoding, PlyElement, PlyProperty, Scalar};
use crate::fault::{Fault, fault};
use crate::text::{LineWords, Lines, number, quoted};

/// The data after the header of a PLY file, read in sequence. ASCII files hold one row per line;
/// blank lines are ignored.
pub(super) struct Body<'a> {
    data: Data<'a>,
}

enum Data<'a> {
    Text {
        lines: Lines<'a>,
        line: usize,
        words: LineWords<'a>,
    },
    Binary {
        bytes: &'a [u8],
        big_endian: bool,
    },
}

/// The position of a row in a PLY file, for messages.
#[derive(Clone, Copy)]
pub(super) struct PlyRow<'a> {
    element: &'a PlyElement,
    index: usize,
    line: Option<usize>,
}

/// The text found in place of a value, and a description of the values that are allowed.
type PlyTrouble = (String, String);

impl<'a> Body<'a> {
    pub(super) fn new(lines: Lines<'a>, encoding: Encoding) -> Self {
        let data = match encoding {
            Encoding::Ascii => Data::Text {
                lines,
                line: 0,
                words: LineWords::default(),
            },
            _ => Data::Binary {
                bytes: lines.rest,
                big_endian: encoding == Encoding::BigEndian,
            },
        };
        Self { data }
    }

    /// Calls `each` with each row of an element. Each row has a list of values for each property.
    pub(super) fn rows(
        &mut self,
        element: &PlyElement,
        mut each: impl FnMut(PlyRow<'_>, &[Vec<f64>]) -> Result<(), Fault>,
    ) -> Result<(), Fault> {
        let mut values = vec![Vec::new(); element.properties.len()];
        for index in 0..element.count {
            let row = self.begin(element, index);
            for (property, values) in element.properties.iter().zip(&mut values) {
                self.property(row, property, values)
                    .map_err(|(value, allowed)| fault(row.place(&property.name), value, allowed))?;
            }
            self.finish(row)?;
            each(row, &values)?;
        }
        Ok(())
    }

    fn begin<'e>(&mut self, element: &'e PlyElement, index: usize) -> PlyRow<'e> {
        let line = match &mut self.data {
            Data::Binary { .. } => None,
            Data::Text { lines, line, words } => {
                let next = lines.find(|(_, text)| !text.is_empty());
                let (number, text) = next.unwrap_or((*line + 1, &[]));
                (*line, *words) = (number, LineWords(text));
                Some(number)
            }
        };
        PlyRow {
            element,
            index,
            line,
        }
    }

    fn property(
        &mut self,
        row: PlyRow<'_>,
        property: &PlyProperty,
        values: &mut Vec<f64>,
    ) -> Result<(), PlyTrouble> {
        values.clear();
        let count = match property.length {
            None => 1,
            Some(scalar) => {
                let length = self.scalar(row, scalar)?;
                whole(length).ok_or_else(|| {
                    let allowed = "a list that begins with its length";
                    (format!("{length} long"), allowed.to_string())
                })?
            }
        };
        // The list of values grows as it is read, because the length stated in the file cannot be
        // trusted.
        for _ in 0..count {
            values.push(self.scalar(row, property.scalar)?);
        }
        Ok(())
    }

    fn scalar(&mut self, row: PlyRow<'_>, scalar: Scalar) -> Result<f64, PlyTrouble> {
        let file_ends = || {
            let PlyElement { name, count, .. } = row.element;
            let allowed = format!("{count} rows of element {name}, as the header states");
            ("missing, because the file ends".to_string(), allowed)
        };
        let line_ends = || {
            let allowed = "a value for each property in the header";
            (
                "missing, because the line ends".to_string(),
                allowed.to_string(),
            )
        };
        match &mut self.data {
            Data::Text { lines, words, .. } => match words.next() {
                Some(word) => number(word).ok_or_else(|| (quoted(word), "a number".into())),
                None if lines.rest.trim_ascii().is_empty() => Err(file_ends()),
                None => Err(line_ends()),
            },
            Data::Binary { bytes, big_endian } => {
                let (raw, rest) = bytes
                    .split_at_checked(scalar.size())
                    .ok_or_else(file_ends)?;
                *bytes = rest;
                Ok(decode(scalar, raw, *big_endian))
            }
        }
    }

    fn finish(&mut self, row: PlyRow<'_>) -> Result<(), Fault> {
        match &mut self.data {
            Data::Text { words, .. } => words.next().map_or(Ok(()), |word| {
                let allowed = "the end of the line, after the stated properties";
                Err(fault(row.place("the next word"), quoted(word), allowed))
            }),
            Data::Binary { .. } => Ok(()),
        }
    }

    /// Checks that the file ends after the announced data.
    pub(super) fn end(self) -> Result<(), Fault> {
        let rest = match self.data {
            Data::Text { lines, .. } => lines.rest,
            Data::Binary { bytes, .. } => bytes,
        };
        let rest = rest.trim_ascii();
        if rest.is_empty() {
            return Ok(());
        }
        let value = format!("{} bytes long", rest.len());
        let allowed = "empty, because the header states no more elements";
        Err(fault("the rest of the file", value, allowed))
    }
}

impl PlyRow<'_> {
    pub(super) fn place(self, what: &str) -> String {
        let line = self.line.map(|line| format!("line {line}, "));
        let line = line.unwrap_or_default();
        format!("{line}{} {}, {what}", self.element.name, self.index)
    }
}

/// The value of a PLY number. The type f64 represents the values of all eight PLY types
/// exactly.
fn decode(scalar: Scalar, raw: &[u8], big_endian: bool) -> f64 {
    let mut little = [0; 8];
    little[..raw.len()].copy_from_slice(raw);
    if big_endian {
        little[..raw.len()].reverse();
    }
    let [a, b, c, d, ..] = little;
    match scalar {
        Scalar::I8 => i8::from_le_bytes([a]).into(),
        Scalar::U8 => a.into(),
        Scalar::I16 => i16::from_le_bytes([a, b]).into(),
        Scalar::U16 => u16::from_le_bytes([a, b]).into(),
        Scalar::I32 => i32::from_le_bytes([a, b, c, d]).into(),
        Scalar::U32 => u32::from_le_bytes([a, b, c, d]).into(),
        Scalar::F32 => f32::from_le_bytes([a, b, c, d]).into(),
        Scalar::F64 => f64::from_le_bytes(little),
    }
}

/// A value as a count or an index, if the value is a whole number in the range of u32.
pub(super) fn whole(value: f64) -> Option<u32> {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the value was checked to be whole and in range"
    )]
    let cast = |value| value as u32;
    let fits = (0.0..=f64::from(u32::MAX)).contains(&value) && value.fract() == 0.0;
    fits.then(|| cast(value))
}
