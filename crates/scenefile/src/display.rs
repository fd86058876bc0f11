//! Displays text from users and files in messages.

use std::fmt::{self, Display, Write};

/// Returns `value` as formatted text. The text has at most `most` characters, and all of them are
/// safe for a terminal.
///
/// Control and format characters (including those that change the direction of text), line
/// separators, private-use characters and non-characters are escaped as `\u{..}`. A text that is
/// too long ends in `…`, and its omitted part is never formatted.
#[must_use]
pub fn shown(value: impl Display, most: usize) -> String {
    let mut cut = ShortenedText {
        text: String::new(),
        left: most,
    };
    if write!(cut, "{value}").is_err() {
        cut.text.push('…');
    }
    cut.text
}

/// A number in its usual notation.
#[must_use]
pub fn number(x: f64) -> String {
    let is_plain = x == 0.0 || !x.is_finite() || (1e-4..1e6).contains(&x.abs());
    if is_plain {
        x.to_string()
    } else {
        format!("{x:e}")
    }
}

/// A text that accepts a limited number of further characters, and marks an omission by `…`.
struct ShortenedText {
    text: String,
    left: usize,
}

impl Write for ShortenedText {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for c in text.chars() {
            let length = if is_printable(c) {
                1
            } else {
                c.escape_unicode().count()
            };
            self.left = self.left.checked_sub(length).ok_or(fmt::Error)?;
            if length == 1 {
                self.text.push(c);
            } else {
                self.text.extend(c.escape_unicode());
            }
        }
        Ok(())
    }
}

/// Checks whether a character is visible, a plain space, or a mark on the previous character.
#[must_use]
pub fn is_printable(c: char) -> bool {
    if c.is_ascii() {
        return !c.is_ascii_control();
    }
    // Rust's debug escapes follow Unicode's categories. Rust's debug format does not escape a
    // mark unless it is the first character.
    let mut after = [b'a'; 5];
    let end = 1 + c.encode_utf8(&mut after[1..]).len();
    let text = std::str::from_utf8(&after[..end]);
    text.is_ok_and(|text| text.escape_debug().count() == 2)
}

#[cfg(test)]
mod tests {
    use super::shown;

    #[test]
    fn what_a_terminal_obeys_is_escaped() {
        for (text, as_shown) in [
            ("a b é 床 पटल שלום \\ \"'", "a b é 床 पटल שלום \\ \"'"),
            (
                "\u{1b}[2J\r\n\t\u{7f}",
                "\\u{1b}[2J\\u{d}\\u{a}\\u{9}\\u{7f}",
            ),
            ("\u{85}\u{9b}\u{a0}", "\\u{85}\\u{9b}\\u{a0}"),
            ("\u{202e}\u{2066}\u{200f}", "\\u{202e}\\u{2066}\\u{200f}"),
            ("\u{2028}\u{2029}\u{feff}", "\\u{2028}\\u{2029}\\u{feff}"),
            (
                "\u{e000}\u{fffe}\u{10ffff}",
                "\\u{e000}\\u{fffe}\\u{10ffff}",
            ),
        ] {
            assert_eq!(shown(text, 100), as_shown);
        }
    }

    #[test]
    fn what_is_too_long_is_cut_and_not_formatted() {
        assert_eq!(shown("床床床", 3), "床床床");
        assert_eq!(shown("床床床床", 3), "床床床…");
        // An escape sequence is shown completely or not at all.
        assert_eq!(shown("ab\u{1b}", 7), "ab…");
        assert_eq!(shown("ab\u{1b}", 8), "ab\\u{1b}");

        struct Endless;
        impl std::fmt::Display for Endless {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                loop {
                    f.write_str("more ")?;
                }
            }
        }
        assert_eq!(shown(Endless, 7), "more mo…");
    }
}
