//! Reads scene files; if a file cannot be read, the error names the faulty field.

use crate::display::shown;
use crate::hints::{example, has_fields, wanted};
use crate::messages::{path_of, unfit};
use crate::place::{ScenePlace, find, word};
use crate::suggestion::did_you_mean;
use crate::{SceneError, SceneFile, limits};
use ron::error::{Error, SpannedError};
use serde::Deserialize;
use serde_path_to_error::Track;

impl SceneFile {
    /// Reads a scene file: in JSON if the file begins with a brace, otherwise in RON.
    ///
    /// # Errors
    /// [`SceneError::Syntax`] with the line, the column and what is allowed there.
    pub fn parse(text: &str) -> Result<Self, SceneError> {
        // Some editors begin a file with a byte order mark.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        if text.trim_start().starts_with('{') {
            return json(text);
        }
        let what = match text.trim_start().chars().next() {
            None => Some(format!("the file is empty; allowed: {}", wanted(""))),
            Some('<') => Some("this is XML, such as a scene of Mitsuba 3; allowed: a scene in RON or JSON (only the commands render, import and probe read XML)".to_owned()),
            Some(_) => None,
        };
        if let Some(message) = what {
            return Err(SceneError::Syntax {
                line: 1,
                column: 1,
                message,
            });
        }
        let options = ron::Options::default()
            .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
        options.from_str(text).map_err(|error| {
            // Reads the file again to locate the fault; only a faulty file is read twice.
            let mut track = Track::new();
            if let Ok(mut ron) = ron::Deserializer::from_str_with_options(text, &options) {
                let tracked = serde_path_to_error::Deserializer::new(&mut ron, &mut track);
                let _ = Self::deserialize(tracked);
            }
            syntax(text, &path_of(&track.path()), &error)
        })
    }
}

/// Reads a scene file in JSON.
fn json(text: &str) -> Result<SceneFile, SceneError> {
    let mut json = serde_json::Deserializer::from_str(text);
    let file = serde_path_to_error::deserialize(&mut json);
    file.map_err(|error| SceneError::Syntax {
        line: error.inner().line(),
        column: error.inner().column(),
        message: shown(unfit(&error), limits::ALLOWED),
    })
    .and_then(|file| match json.end() {
        Ok(()) => Ok(file),
        Err(error) => Err(SceneError::Syntax {
            line: error.line(),
            column: error.column(),
            message: "allowed: nothing after the last bracket".to_owned(),
        }),
    })
}

/// The path of the field `field` within the field at `path`.
fn below(path: &str, field: &str) -> String {
    let dot = if path.is_empty() { "" } else { "." };
    format!("{path}{dot}{}", shown(field, limits::NAME))
}

/// Describes the error of a file that has a fault in the field at a path.
fn syntax(text: &str, path: &str, error: &SpannedError) -> SceneError {
    let [start, end] = [error.span.start, error.span.end].map(|at| [at.line, at.col]);
    let value = find(text, path);
    let whole = value.map_or(start, |value| [value.line, value.column]);
    let name = if path.is_empty() { "the scene" } else { path };
    let code = &error.code;
    let is_whole = |_: &ScenePlace<'_>| [start, end].contains(&whole) || is_shape(code, path);
    let (at, message) = if let Some((is_whole, message)) = of_names(code, name, path) {
        (if is_whole { whole } else { start }, message)
    } else if let Some(ScenePlace { value, .. }) = value.filter(is_whole) {
        let message = format!("{name} is {}; allowed: {}", excerpt(value), wanted(path));
        (whole, message)
    } else {
        let at = if *code == Error::Eof { end } else { start };
        (at, format!("{name}: {}", unexpected(code, text, at)))
    };
    let [line, column] = at;
    let message = shown(message, limits::ALLOWED);
    SceneError::Syntax {
        line,
        column,
        message,
    }
}

/// Describes an error in the name of a variant or a field. Also returns whether the error concerns
/// the entire value. Returns `None` for other errors.
fn of_names(code: &Error, name: &str, path: &str) -> Option<(bool, String)> {
    Some(match code {
        Error::NoSuchEnumVariant {
            expected, found, ..
        } => {
            let meant = did_you_mean(found, expected.iter().copied());
            let found = shown(found, limits::NAME);
            let known = expected.join(", ");
            let such_as = match example(path) {
                word if expected.contains(&word) => String::new(),
                example => format!(", such as {example}"),
            };
            (
                true,
                format!("{name} is {found}{meant}; allowed: {known}{such_as}"),
            )
        }
        Error::NoSuchStructField {
            expected, found, ..
        } => {
            let meant = did_you_mean(found, expected.iter().copied());
            let known = expected.join(", ");
            // The path already ends with the name of the field.
            let of = path.strip_suffix(found.as_str()).unwrap_or(path);
            let field = below(of.trim_end_matches('.'), found);
            (
                false,
                format!("{field} is no field{meant}; allowed: {known}"),
            )
        }
        Error::MissingStructField { field, .. } => {
            let field = below(path, field);
            (
                true,
                format!("{field} is missing; allowed: {}", wanted(&field)),
            )
        }
        Error::DuplicateStructField { field, .. } => {
            let field = below(path, field);
            (false, format!("{field} is given twice; allowed: once"))
        }
        _ => return None,
    })
}

/// Checks whether an error that was found inside a value concerns the entire value, which is a
/// number, a name or a vector.
fn is_shape(code: &Error, path: &str) -> bool {
    let is_cut = matches!(
        code,
        Error::Eof
            | Error::ExpectedStringEnd
            | Error::UnclosedBlockComment
            | Error::TrailingCharacters
    );
    !is_cut && !has_fields(path)
}

/// The text at a position between fields, and the text that is allowed at this position.
fn unexpected(code: &Error, text: &str, [line, column]: [usize; 2]) -> String {
    let rest = text.lines().nth(line - 1).unwrap_or_default();
    let at = rest.char_indices().nth(column - 1);
    let (before, rest) = rest.split_at(at.map_or(rest.len(), |(at, _)| at));
    let is_digit = |c: char| c.is_ascii_digit();
    let found = shown(&rest[..word(rest)], EXCERPT);
    let allowed = match code {
        Error::Eof => {
            return "the file ends here, but a bracket is still open; allowed: the missing fields and `)`"
                .into();
        }
        Error::ExpectedComma if rest.starts_with('^') => {
            "a number without the sign ^, such as 1_048_576 or 1e6"
        }
        Error::ExpectedComma if before.ends_with(is_digit) => "a number without a unit",
        Error::ExpectedComma => "a comma before it, or a closing bracket",
        Error::ExpectedIdentifier | Error::SuggestRawIdentifier(_)
            if rest.starts_with(is_digit) =>
        {
            "the name of a field; decimals have a point, such as 0.1"
        }
        Error::ExpectedIdentifier => "the name of a field, or `)`",
        Error::ExpectedMapColon => "a colon after the name of a field",
        Error::TrailingCharacters => "nothing after the last bracket",
        code => return format!("unexpected `{found}`: {}", shown(code, limits::VALUE)),
    };
    format!("unexpected `{found}`; allowed: {allowed}")
}

/// The beginning of a value, on one line.
fn excerpt(value: &str) -> String {
    // Only the beginning of the value is used, because a word may be as long as the entire file.
    let start: String = value.chars().take(4 * EXCERPT).collect();
    let words: Vec<&str> = start.split_whitespace().collect();
    shown(words.join(" "), EXCERPT)
}

/// The maximum number of characters of a value that a message shows.
const EXCERPT: usize = 60;
