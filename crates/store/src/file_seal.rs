//! Marks files that this program writes. The mark is a hash of all other bytes, near the end of the
//! file. If the hash matches, the file has not changed since this program wrote it, and may be
//! replaced.

use std::path::Path;

/// The kind of file, which determines how the mark is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SealKind {
    /// HTML or SVG. The mark is a comment in the last line.
    Markup,
    /// PNG. The mark is a text chunk before the last chunk.
    Png,
}

const BEFORE: &str = "\n<!-- etendue ";
const AFTER: &str = " -->\n";
/// Keyword and start of the text of a PNG's chunk.
const TEXT: &[u8] = b"Software\0etendue ";
/// Bytes of a PNG's last chunk, which is empty.
const LAST: usize = 12;
/// Digits of a hash.
const DIGITS: usize = 64;

impl SealKind {
    /// The kind of a page or a picture, by the extension of its file.
    #[must_use]
    pub fn of(file: &Path) -> Option<Self> {
        match file.extension()?.to_str()? {
            "html" | "svg" => Some(Self::Markup),
            "png" => Some(Self::Png),
            _ => None,
        }
    }

    /// The file with its mark.
    #[must_use]
    pub fn sealed(self, bytes: &[u8]) -> Vec<u8> {
        let hash = blake3::hash(bytes).to_hex();
        let (start, mark, end) = match self {
            Self::Markup => {
                let mark = format!("{BEFORE}{hash}{AFTER}").into_bytes();
                (bytes, mark, &[][..])
            }
            Self::Png => {
                let (start, end) = bytes.split_at(bytes.len().saturating_sub(LAST));
                (start, chunk(&[TEXT, hash.as_bytes()].concat()), end)
            }
        };
        [start, &mark, end].concat()
    }

    /// Checks whether a file bears its own mark.
    #[must_use]
    pub fn is_sealed(self, bytes: &[u8]) -> bool {
        let (mark, last) = match self {
            Self::Markup => (BEFORE.len() + DIGITS + AFTER.len(), 0),
            Self::Png => (LAST + TEXT.len() + DIGITS, LAST),
        };
        let Some(start) = bytes.len().checked_sub(mark + last) else {
            return false;
        };
        let before = [&bytes[..start], &bytes[bytes.len() - last..]].concat();
        self.sealed(&before) == bytes
    }
}

/// A text chunk of a PNG: its length, kind, data and checksum.
fn chunk(data: &[u8]) -> Vec<u8> {
    let summed = [b"tEXt", data].concat();
    let length = u32::try_from(data.len()).unwrap_or(0).to_be_bytes();
    let sum = crc32fast::hash(&summed).to_be_bytes();
    [&length[..], &summed, &sum].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checksum_is_that_of_png() {
        // The check value of CRC-32, and the checksum of every PNG's last chunk.
        assert_eq!(crc32fast::hash(b"123456789"), 0xcbf4_3926);
        assert_eq!(crc32fast::hash(b"IEND"), 0xae42_6082);
    }

    #[test]
    fn a_changed_file_does_not_bear_its_mark() {
        let end = [&[0; 4], &b"IEND"[..], &0xae42_6082_u32.to_be_bytes()].concat();
        let png = [b"\x89PNG and pixels", &end[..]].concat();
        for (kind, bytes) in [
            (SealKind::Markup, b"<svg></svg>".to_vec()),
            (SealKind::Png, png),
        ] {
            let mut sealed = kind.sealed(&bytes);
            assert!(kind.is_sealed(&sealed));
            assert!(!kind.is_sealed(&bytes));
            assert!(!kind.is_sealed(b""));
            sealed[3] ^= 1;
            assert!(!kind.is_sealed(&sealed));
        }
    }
}
