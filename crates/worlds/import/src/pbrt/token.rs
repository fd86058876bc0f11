//! Tokens of a pbrt file: words, strings and brackets, with their places.

use crate::report::SourcePlace;
use std::borrow::Cow;
use std::rc::Rc;

/// All directives of pbrt-v4.
const DIRECTIVES: [&str; 38] = [
    "Accelerator",
    "ActiveTransform",
    "AreaLightSource",
    "Attribute",
    "AttributeBegin",
    "AttributeEnd",
    "Camera",
    "ColorSpace",
    "ConcatTransform",
    "CoordSysTransform",
    "CoordinateSystem",
    "Film",
    "Identity",
    "Import",
    "Include",
    "Integrator",
    "LightSource",
    "LookAt",
    "MakeNamedMaterial",
    "MakeNamedMedium",
    "Material",
    "MediumInterface",
    "NamedMaterial",
    "ObjectBegin",
    "ObjectEnd",
    "ObjectInstance",
    "Option",
    "PixelFilter",
    "ReverseOrientation",
    "Rotate",
    "Sampler",
    "Scale",
    "Shape",
    "Texture",
    "Transform",
    "TransformTimes",
    "Translate",
    "WorldBegin",
];

/// Directives of pbrt-v3, replaced by `AttributeBegin` and `AttributeEnd`.
const LEGACY: [&str; 2] = ["TransformBegin", "TransformEnd"];

/// A token.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token<'a> {
    /// A word without quotes: a directive, a number or a truth value.
    Word(&'a str),
    /// A quoted string.
    Text(Cow<'a, str>),
    /// `[`
    Open,
    /// `]`
    Close,
    /// Invalid text, with the reason.
    Broken(&'static str),
}

/// A line and a column, both from 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct LineColumn {
    line: usize,
    column: usize,
}

/// The tokens of a file in order; comments are skipped.
#[derive(Debug)]
pub(super) struct Tokens<'a> {
    file: Rc<str>,
    rest: &'a str,
    /// The current position.
    pub(super) at: LineColumn,
    peeked: Option<(Token<'a>, LineColumn)>,
}

impl<'a> Tokens<'a> {
    pub(super) fn new(text: &'a str, file: &str) -> Self {
        Self {
            file: file.into(),
            rest: text,
            at: LineColumn { line: 1, column: 1 },
            peeked: None,
        }
    }

    /// A place in this file.
    pub(super) fn place(&self, at: LineColumn) -> SourcePlace {
        SourcePlace::at(&self.file, at.line, at.column)
    }

    /// The next token without consuming it.
    pub(super) fn peek(&mut self) -> Option<&(Token<'a>, LineColumn)> {
        if self.peeked.is_none() {
            self.peeked = self.read();
        }
        self.peeked.as_ref()
    }

    /// The next token, unless it begins a directive or the file ends.
    pub(super) fn peek_value(&mut self) -> Option<(Token<'a>, LineColumn)> {
        let next = self.peek().cloned();
        next.filter(|(token, _)| !matches!(token, Token::Word(word) if is_directive(word)))
    }

    /// Consumes the next token; `None` at the end of the file.
    pub(super) fn next(&mut self) -> Option<(Token<'a>, LineColumn)> {
        self.peeked.take().or_else(|| self.read())
    }

    fn read(&mut self) -> Option<(Token<'a>, LineColumn)> {
        self.skip();
        let at = self.at;
        let start = self.rest;
        let token = match self.bump()? {
            '[' => Token::Open,
            ']' => Token::Close,
            '"' => self.text(),
            _ => {
                while self.rest.starts_with(is_of_word) {
                    self.bump();
                }
                Token::Word(&start[..start.len() - self.rest.len()])
            }
        };
        Some((token, at))
    }

    /// Skips white space and comments.
    fn skip(&mut self) {
        loop {
            if self.rest.starts_with('#') {
                while self.rest.starts_with(|c| c != '\n' && c != '\r') {
                    self.bump();
                }
            } else if self.rest.starts_with(is_space) {
                self.bump();
            } else {
                return;
            }
        }
    }

    /// Parses a string after its opening quotation mark.
    fn text(&mut self) -> Token<'a> {
        let start = self.rest;
        let mut escaped: Option<String> = None;
        loop {
            let before = &start[..start.len() - self.rest.len()];
            let Some(c) = self.bump().filter(|c| *c != '\n') else {
                return Token::Broken("a string has no closing quotation mark");
            };
            let made = match c {
                '"' => {
                    return Token::Text(escaped.map_or(Cow::Borrowed(before), Cow::Owned));
                }
                '\\' => {
                    escaped.get_or_insert_with(|| before.to_owned());
                    let Some(c) = self.bump().and_then(escape) else {
                        return Token::Broken(
                            "a \\ stands before a character that cannot be escaped",
                        );
                    };
                    c
                }
                other => other,
            };
            if let Some(escaped) = &mut escaped {
                escaped.push(made);
            }
        }
    }

    fn bump(&mut self) -> Option<char> {
        let c = self.rest.chars().next()?;
        self.rest = &self.rest[c.len_utf8()..];
        if c == '\n' {
            self.at.line += 1;
            self.at.column = 1;
        } else {
            self.at.column += 1;
        }
        Some(c)
    }
}

fn is_space(c: char) -> bool {
    matches!(c, ' ' | '\n' | '\t' | '\r')
}

fn is_of_word(c: char) -> bool {
    !is_space(c) && !matches!(c, '"' | '[' | ']')
}

fn escape(c: char) -> Option<char> {
    Some(match c {
        'b' => '\u{8}',
        'f' => '\u{c}',
        'n' => '\n',
        'r' => '\r',
        't' => '\t',
        '\\' | '\'' | '"' => c,
        _ => return None,
    })
}

/// Parses a finite number; `Err` describes a fault. Does not check whether integers are in range.
pub(super) fn number(word: &str) -> Result<f64, String> {
    let parsed: Option<f64> = word.parse().ok();
    let finite = parsed.filter(|value| value.is_finite());
    finite.ok_or_else(|| format!("{} is not a finite number", crate::report::quoted(word)))
}

/// Checks whether a word is a directive.
pub(super) fn is_directive(word: &str) -> bool {
    DIRECTIVES.binary_search(&word).is_ok() || LEGACY.contains(&word)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directives_are_found() {
        assert!(DIRECTIVES.is_sorted());
        assert!(is_directive("Accelerator") && is_directive("WorldBegin"));
        assert!(!is_directive("WorldEnd"));
    }
}
