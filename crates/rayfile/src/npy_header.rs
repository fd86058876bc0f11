//! Reads and writes headers of NPY files. Format: NumPy Enhancement Proposal 1 (Kern 2007) and
//! `numpy.lib.format`, versions 1.0 to 3.0.

/// The description of the array in the header of an NPY file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NpyHeader {
    /// The type of an element in NumPy's notation: `<f8` for f64 with the lowest byte first.
    pub descr: String,
    /// Whether the first index varies fastest, as in Fortran.
    pub fortran_order: bool,
    /// The length of each axis.
    pub shape: Vec<u64>,
}

const MAGIC: &[u8] = b"\x93NUMPY";
/// Bytes before the dictionary in version 1.0.
const PREAMBLE: usize = 10;
/// The largest length of a header that is read; headers of numeric arrays have 118 bytes.
const MAX_DICTIONARY: usize = 1024;

impl NpyHeader {
    /// The header of an array in C order.
    #[must_use]
    pub fn new(descr: &str, shape: &[u64]) -> Self {
        Self {
            descr: descr.into(),
            fortran_order: false,
            shape: shape.to_vec(),
        }
    }

    /// The header in version 1.0, padded so that the data begin at a multiple of 64 bytes.
    #[must_use]
    pub fn bytes(&self) -> Vec<u8> {
        let Self {
            descr,
            fortran_order,
            shape,
        } = self;
        let order = if *fortran_order { "True" } else { "False" };
        // In Python, a tuple of one element needs a comma.
        let shape = match shape.as_slice() {
            [one] => format!("{one},"),
            all => all
                .iter()
                .map(u64::to_string)
                .collect::<Vec<_>>()
                .join(", "),
        };
        let dictionary =
            format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': ({shape}), }}");
        let length = (PREAMBLE + dictionary.len() + 1).next_multiple_of(64) - PREAMBLE;
        let mut header = [MAGIC, &[1, 0]].concat();
        // NumPy allows at most 64 axes, so the length fits in 16 bits.
        header.extend(u16::try_from(length).unwrap_or(u16::MAX).to_le_bytes());
        header.extend(format!("{dictionary:<width$}\n", width = length - 1).bytes());
        header
    }

    /// The header at the beginning of a file, and the offset of its data. Returns `None`
    /// if the file has no header of a numeric array. NumPy allows any Python literal in a header,
    /// but this function reads only flat dictionaries.
    #[must_use]
    pub fn read(file: &[u8]) -> Option<(Self, usize)> {
        let rest = file.strip_prefix(MAGIC)?;
        let (start, length) = match rest {
            [1, _, a, b, ..] => (PREAMBLE, u32::from(u16::from_le_bytes([*a, *b]))),
            [2 | 3, _, a, b, c, d, ..] => (PREAMBLE + 2, u32::from_le_bytes([*a, *b, *c, *d])),
            _ => return None,
        };
        let length = usize::try_from(length)
            .ok()
            .filter(|l| *l <= MAX_DICTIONARY)?;
        let dictionary = str::from_utf8(file.get(start..start + length)?).ok()?;
        let header = Self::parse(dictionary.trim())?;
        Some((header, start + length))
    }

    /// Reads `{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }`.
    fn parse(dictionary: &str) -> Option<Self> {
        let body = dictionary.strip_prefix('{')?.strip_suffix('}')?;
        let (before, rest) = body.split_once('(')?;
        let (shape, after) = rest.split_once(')')?;
        let (mut descr, mut fortran_order, mut has_shape) = (None, None, false);
        for entry in before.split(',').chain(after.split(',')).map(str::trim) {
            if entry.is_empty() {
                continue;
            }
            let (key, value) = entry.split_once(':')?;
            match (unquoted(key)?, value.trim()) {
                ("descr", value) if descr.is_none() => descr = Some(unquoted(value)?.to_owned()),
                ("fortran_order", value) if fortran_order.is_none() => {
                    fortran_order = Some(match value {
                        "True" => true,
                        "False" => false,
                        _ => return None,
                    });
                }
                ("shape", "") if !has_shape => has_shape = true,
                _ => return None,
            }
        }
        let axes = shape
            .split(',')
            .map(str::trim)
            .filter(|axis| !axis.is_empty());
        let header = Self {
            descr: descr?,
            fortran_order: fortran_order?,
            shape: axes.map(|axis| axis.parse().ok()).collect::<Option<_>>()?,
        };
        has_shape.then_some(header)
    }
}

/// The content of a quoted Python string. Returns `None` if the text is not such a string,
/// or if the string contains an escape.
fn unquoted(text: &str) -> Option<&str> {
    let text = text.trim();
    let quote = text.chars().next().filter(|c| matches!(c, '\'' | '"'))?;
    let content = text.strip_prefix(quote)?.strip_suffix(quote)?;
    (!content.contains([quote, '\\'])).then_some(content)
}

#[cfg(test)]
mod tests {
    use super::NpyHeader;

    fn file(dictionary: &str) -> Vec<u8> {
        let length = u16::try_from(dictionary.len()).unwrap_or(u16::MAX);
        let length: &[u8] = &length.to_le_bytes();
        [b"\x93NUMPY\x01\x00", length, dictionary.as_bytes()].concat()
    }

    #[test]
    fn what_is_written_is_read_back() {
        for shape in [&[][..], &[7], &[0, 3], &[1 << 40, 2, 3, 4]] {
            let header = NpyHeader::new("<c16", shape);
            let mut bytes = header.bytes();
            assert_eq!(bytes.len() % 64, 0);
            let end = bytes.len();
            bytes.extend([1, 2, 3]);
            assert_eq!(NpyHeader::read(&bytes), Some((header, end)));
        }
    }

    #[test]
    fn headers_of_numpy_are_read() {
        let read = |text: &str| NpyHeader::read(&file(text)).map(|(header, _)| header);
        let numpy = "{'descr': '<f8', 'fortran_order': True, 'shape': (2, 3), }   \n";
        let header = NpyHeader {
            fortran_order: true,
            ..NpyHeader::new("<f8", &[2, 3])
        };
        assert_eq!(read(numpy), Some(header));
        // Other programs write the header in this notation.
        let other = r#"{"shape": (5,), "fortran_order": False, "descr": "<f8"}"#;
        assert_eq!(read(other), Some(NpyHeader::new("<f8", &[5])));
    }

    #[test]
    fn what_is_no_array_of_numbers_is_refused() {
        let whole = NpyHeader::new("<f8", &[2, 3]).bytes();
        for end in 0..whole.len() {
            assert_eq!(NpyHeader::read(&whole[..end]), None);
        }
        for text in [
            "",
            "{}",
            "{'descr': '<f8', 'fortran_order': False, }",
            "{'descr': '<f8', 'fortran_order': False, 'shape': 3}",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (-3,)}",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999999999999,)}",
            "{'descr': '<f8', 'fortran_order': 0, 'shape': (3,)}",
            "{'descr': '<f8', 'descr': '<f4', 'fortran_order': False, 'shape': (3,)}",
            "{'descr': [('x', '<f8')], 'fortran_order': False, 'shape': (3,)}",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (3,), 'more': 1}",
            "'descr': '<f8', 'fortran_order': False, 'shape': (3,)",
        ] {
            assert_eq!(NpyHeader::read(&file(text)), None, "{text}");
        }
    }

    #[test]
    fn nested_brackets_are_refused_at_once() {
        let nested = format!("{{'descr': {}{}", "[".repeat(900), "]".repeat(90));
        assert_eq!(NpyHeader::read(&file(&nested)), None);
    }
}
