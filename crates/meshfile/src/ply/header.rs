//! Reads the header of a PLY file.

use crate::fault::{Fault, fault};
use crate::text::{LineWords, Lines, number, quoted};
use std::collections::HashSet;

/// The description of the data in a PLY file.
pub(super) struct PlyHeader {
    pub(super) encoding: Encoding,
    /// The elements, in the order of the data.
    pub(super) elements: Vec<PlyElement>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// A table of a PLY file, such as the table of vertices.
pub(super) struct PlyElement {
    pub(super) name: String,
    pub(super) count: usize,
    pub(super) properties: Vec<PlyProperty>,
}

/// A column of a table of a PLY file.
pub(super) struct PlyProperty {
    pub(super) name: String,
    pub(super) scalar: Scalar,
    /// The type of the list's length; `None` if the property is not a list.
    pub(super) length: Option<Scalar>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

const FORMATS: &str =
    "format ascii 1.0, format binary_little_endian 1.0, format binary_big_endian 1.0";
const ELEMENT: &str = "element NAME COUNT, a name of at most 100 bytes";
const PROPERTIES: &str = "property TYPE NAME, property list TYPE TYPE NAME; char, uchar, short, ushort, int, uint, float, double; a name of at most 100 bytes";
/// The maximum length of a name in bytes; the length is limited because messages repeat names.
const LONGEST_NAME: usize = 100;
/// The largest number of PLY elements that a message lists.
const MOST_LISTED: usize = 4;

impl PlyHeader {
    /// The header of a PLY file, and the lines after the header.
    pub(super) fn read(bytes: &[u8]) -> Result<(Self, Lines<'_>), Fault> {
        let mut lines = Lines::new(bytes);
        let first = lines.next().map_or(&[][..], |(_, line)| line);
        if first != b"ply" {
            return Err(fault("line 1", quoted(first), "ply"));
        }
        let mut encoding = None;
        let mut elements: Vec<PlyElement> = Vec::new();
        // Hash sets hold the names of all elements and the names of the last element's properties.
        // Therefore the time to read a header is proportional to its length.
        let (mut known, mut properties) = (HashSet::new(), HashSet::new());
        for (at, line) in lines.by_ref() {
            let refused = |allowed: &str| fault(format!("line {at}"), quoted(line), allowed);
            let words: Vec<&[u8]> = LineWords(line).collect();
            match words.as_slice() {
                [] | [b"comment" | b"obj_info", ..] => {}
                [b"format", ..] if encoding.is_some() => {
                    return Err(refused("one format line"));
                }
                [b"format", rest @ ..] => {
                    encoding = Some(format(rest).ok_or_else(|| refused(FORMATS))?);
                }
                [b"element", rest @ ..] => {
                    let new = element(rest).ok_or_else(|| refused(ELEMENT))?;
                    if !known.insert(new.name.clone()) {
                        return Err(refused("each element once"));
                    }
                    properties.clear();
                    elements.push(new);
                }
                [b"property", rest @ ..] => {
                    let new = property(rest).ok_or_else(|| refused(PROPERTIES))?;
                    let Some(element) = elements.last_mut() else {
                        return Err(refused("an element that stands before its properties"));
                    };
                    if !properties.insert(new.name.clone()) {
                        return Err(refused("each property once"));
                    }
                    element.properties.push(new);
                }
                [b"end_header"] => {
                    let encoding = encoding.ok_or_else(|| fault("format", "missing", FORMATS))?;
                    let header = Self { encoding, elements };
                    header.check_length(lines.rest.len())?;
                    return Ok((header, lines));
                }
                _ => {
                    let allowed = "format, comment, obj_info, element, property, end_header";
                    return Err(refused(allowed));
                }
            }
        }
        Err(fault(
            "end_header",
            "missing, because the file ends",
            "a complete header",
        ))
    }

    pub(super) fn element(&self, name: &str) -> Result<&PlyElement, Fault> {
        let found = self.elements.iter().find(|e| e.name == name);
        let place = || format!("element {name} of the header");
        found.ok_or_else(|| fault(place(), "missing", "elements vertex and face"))
    }

    /// Checks that the data are long enough for the announced counts. Each row takes at least one
    /// byte, so the length of the file limits time and memory, even if an announced count is
    /// huge.
    fn check_length(&self, length: usize) -> Result<(), Fault> {
        let mut least: u128 = 0;
        for element in self.elements.iter().filter(|e| e.count > 0) {
            if element.properties.is_empty() {
                let place = format!("number of properties of element {}", element.name);
                return Err(fault(place, 0, "at least 1"));
            }
            let row = element.properties.iter().map(|p| p.least(self.encoding));
            least = least.saturating_add(element.count as u128 * row.sum::<usize>() as u128);
        }
        if self.encoding == Encoding::Ascii {
            least = least.saturating_sub(1); // the last line may have no line end
        }
        if (length as u128) < least {
            let rows = self.elements.iter().take(MOST_LISTED);
            let mut rows: Vec<String> = rows.map(|e| format!("{} {}", e.count, e.name)).collect();
            if let Some(more @ 1..) = self.elements.len().checked_sub(MOST_LISTED) {
                rows.push(format!("{more} more elements"));
            }
            let allowed = format!(
                "at least {least}, because the header declares {}",
                rows.join(", ")
            );
            return Err(fault("number of bytes after the header", length, allowed));
        }
        Ok(())
    }
}

impl PlyElement {
    /// The position of the property with a name; `None` unless it is present as a single
    /// number.
    pub(super) fn column(&self, name: &str) -> Option<usize> {
        let mut properties = self.properties.iter();
        properties.position(|p| p.name == name && p.length.is_none())
    }

    /// The positions of the properties with the given names; `None` unless all of these
    /// properties are present as single numbers.
    pub(super) fn columns<const N: usize>(&self, names: [&str; N]) -> Option<[usize; N]> {
        let found = names.map(|name| self.column(name));
        found
            .iter()
            .all(Option::is_some)
            .then(|| found.map(Option::unwrap_or_default))
    }
}

impl PlyProperty {
    /// The minimum number of bytes that the property takes in a row.
    fn least(&self, encoding: Encoding) -> usize {
        match encoding {
            Encoding::Ascii => 2, // a digit and a separator
            _ => self.length.unwrap_or(self.scalar).size(),
        }
    }
}

impl Scalar {
    fn named(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    pub(super) fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }
}

fn format(words: &[&[u8]]) -> Option<Encoding> {
    match words {
        [b"ascii", b"1.0"] => Some(Encoding::Ascii),
        [b"binary_little_endian", b"1.0"] => Some(Encoding::LittleEndian),
        [b"binary_big_endian", b"1.0"] => Some(Encoding::BigEndian),
        _ => None,
    }
}

fn name(word: &[u8]) -> Option<String> {
    (word.len() <= LONGEST_NAME).then(|| String::from_utf8_lossy(word).into())
}

fn element(words: &[&[u8]]) -> Option<PlyElement> {
    let [word, count] = words else { return None };
    Some(PlyElement {
        name: name(word)?,
        count: number(count)?,
        properties: Vec::new(),
    })
}

fn property(words: &[&[u8]]) -> Option<PlyProperty> {
    let (word, scalar, length) = match words {
        [b"list", length, scalar, word] => (word, scalar, Some(Scalar::named(length)?)),
        [scalar, word] => (word, scalar, None),
        _ => return None,
    };
    Some(PlyProperty {
        name: name(word)?,
        scalar: Scalar::named(scalar)?,
        length,
    })
    .filter(|p| !p.length.is_some_and(Scalar::is_float))
}
