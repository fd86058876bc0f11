//! Splits mesh files of arbitrary bytes into lines, words and numbers.

/// The lines of a file, without surrounding white space. Each line has its number, counted from 1.
///
/// Every line ends in the same way as the first line. It ends at a line feed, which may follow a
/// carriage return, or at a carriage return alone (old Macintosh files).
pub(crate) struct Lines<'a> {
    /// The bytes after the last line returned.
    pub(crate) rest: &'a [u8],
    end: u8,
    number: usize,
}

impl<'a> Lines<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        let first_end = bytes.iter().position(|b| matches!(b, b'\n' | b'\r'));
        let end = match first_end.map(|i| &bytes[i..]) {
            Some([b'\r', b'\n', ..]) | None => b'\n',
            Some(rest) => rest[0],
        };
        Self {
            rest: bytes,
            end,
            number: 0,
        }
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        let end = self.rest.iter().position(|b| *b == self.end);
        let (line, rest) = match end {
            Some(end) => (&self.rest[..end], &self.rest[end + 1..]),
            None => (self.rest, &self.rest[self.rest.len()..]),
        };
        self.rest = rest;
        self.number += 1;
        Some((self.number, line.trim_ascii()))
    }
}

/// Words of a line.
#[derive(Clone, Default)]
pub(crate) struct LineWords<'a>(pub(crate) &'a [u8]);

impl<'a> Iterator for LineWords<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<Self::Item> {
        let text = self.0.trim_ascii_start();
        let end = text.iter().position(u8::is_ascii_whitespace);
        let (word, rest) = text.split_at(end.unwrap_or(text.len()));
        self.0 = rest;
        (!word.is_empty()).then_some(word)
    }
}

/// The number that a word represents. The number is decimal with an optional exponent,
/// infinite, or NaN.
pub(crate) fn number<T: std::str::FromStr>(word: &[u8]) -> Option<T> {
    str::from_utf8(word).ok()?.parse().ok()
}

/// The first few bytes of a word, for a message.
pub(crate) fn quoted(bytes: &[u8]) -> String {
    const LONGEST: usize = 40;
    let shown = String::from_utf8_lossy(&bytes[..bytes.len().min(LONGEST)]);
    let more = if bytes.len() > LONGEST { "..." } else { "" };
    format!("`{}{more}`", shown.escape_debug())
}
