//! Parsing of parameter lists, such as `"float radius" 2`.

use super::token::{Token, Tokens, number};
use crate::range::MAX_NUMBER;
use crate::report::{Report, SourcePlace, quoted};
use std::cell::Cell;
use std::rc::Rc;

/// A named value.
#[derive(Debug)]
pub(super) struct PbrtParameter {
    pub(super) kind: ParameterKind,
    pub(super) name: String,
    pub(super) values: ParameterValues,
    pub(super) place: SourcePlace,
    /// Whether the parameter was read.
    pub(super) is_read: Cell<bool>,
}

/// The values of a parameter.
#[derive(Debug)]
pub(super) enum ParameterValues {
    Numbers(Vec<f64>),
    Texts(Vec<String>),
    Truths(Vec<bool>),
    /// Invalid values, for which a cause was added.
    Broken,
}

/// The parameter types of pbrt-v4.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ParameterKind {
    Bool,
    Integer,
    Float,
    Point2,
    Vector2,
    Point3,
    Vector3,
    Normal,
    Text,
    Texture,
    Rgb,
    Blackbody,
    Spectrum,
}

/// All types by name.
const KINDS: [(&str, ParameterKind); 13] = [
    ("bool", ParameterKind::Bool),
    ("integer", ParameterKind::Integer),
    ("float", ParameterKind::Float),
    ("point2", ParameterKind::Point2),
    ("vector2", ParameterKind::Vector2),
    ("point3", ParameterKind::Point3),
    ("vector3", ParameterKind::Vector3),
    ("normal", ParameterKind::Normal),
    ("string", ParameterKind::Text),
    ("texture", ParameterKind::Texture),
    ("rgb", ParameterKind::Rgb),
    ("blackbody", ParameterKind::Blackbody),
    ("spectrum", ParameterKind::Spectrum),
];

impl ParameterKind {
    /// Returns how many numbers one value of the type has.
    fn arity(self) -> usize {
        match self {
            Self::Point2 | Self::Vector2 => 2,
            Self::Point3 | Self::Vector3 | Self::Normal | Self::Rgb => 3,
            _ => 1,
        }
    }

    /// Returns the name of the type in files.
    pub(super) fn name(self) -> &'static str {
        let found = KINDS.iter().find(|(_, kind)| *kind == self);
        found.map_or("", |(name, _)| name)
    }
}

/// Parses all parameters that follow. Faulty parameters are included, as
/// [`ParameterValues::Broken`].
pub(super) fn parameters(tokens: &mut Tokens<'_>, report: &Report) -> Vec<Rc<PbrtParameter>> {
    let mut all = Vec::new();
    while let Some((Token::Text(declared), at)) = tokens.peek().cloned() {
        tokens.next();
        let place = tokens.place(at);
        let values = values(tokens, &place, report);
        let mut words = declared.split([' ', '\t']).filter(|word| !word.is_empty());
        let (Some(kind), Some(name), None) = (words.next(), words.next(), words.next()) else {
            let message = format!("{} is not a type and a name", quoted(&declared));
            report.cause(&place, message);
            continue;
        };
        let Some((_, kind)) = KINDS.iter().find(|(known, _)| *known == kind) else {
            let known = KINDS.map(|(known, _)| known).join(", ");
            let message = format!("a parameter has type {}; allowed: {known}", quoted(kind));
            report.cause(&place, message);
            continue;
        };
        all.push(Rc::new(PbrtParameter {
            values: checked(values, *kind, name, &place, report),
            kind: *kind,
            name: name.to_owned(),
            place,
            is_read: false.into(),
        }));
    }
    all
}

/// Parses one value, or a list of values in brackets.
fn values(tokens: &mut Tokens<'_>, place: &SourcePlace, report: &Report) -> ParameterValues {
    let mut found = None;
    let is_list = matches!(tokens.peek(), Some((Token::Open, _)));
    if is_list {
        tokens.next();
    }
    loop {
        let Some((token, at)) = tokens.peek_value() else {
            let fault = match is_list {
                true => "a list does not end with ]",
                false => "a parameter has no value",
            };
            report.cause(place, fault);
            return ParameterValues::Broken;
        };
        tokens.next();
        let is_end = is_list && token == Token::Close;
        if !is_end && let Err(error) = add(&mut found, token) {
            report.cause(&tokens.place(at), error);
            found = Some(ParameterValues::Broken);
        }
        if is_end || !is_list {
            return found.unwrap_or(ParameterValues::Numbers(Vec::new()));
        }
    }
}

/// Adds a value to values of one type; `Err` describes a fault.
fn add(found: &mut Option<ParameterValues>, token: Token<'_>) -> Result<(), String> {
    let values = found.get_or_insert_with(|| match token {
        Token::Text(_) => ParameterValues::Texts(Vec::new()),
        Token::Word("true" | "false") => ParameterValues::Truths(Vec::new()),
        _ => ParameterValues::Numbers(Vec::new()),
    });
    match (values, token) {
        // One message for each faulty parameter is sufficient.
        (ParameterValues::Broken, _) => {}
        (_, Token::Broken(what)) => return Err(what.to_owned()),
        (_, Token::Open | Token::Close) => {
            return Err("a bracket stands in place of a value".to_owned());
        }
        (ParameterValues::Texts(all), Token::Text(text)) => all.push(text.into_owned()),
        (ParameterValues::Truths(all), Token::Word(word @ ("true" | "false"))) => {
            all.push(word == "true");
        }
        (ParameterValues::Numbers(all), Token::Word(word)) => all.push(number(word)?),
        _ => return Err("a list has values of different types".to_owned()),
    }
    Ok(())
}

/// Returns the values if they match the type; otherwise adds a cause of refusal.
fn checked(
    values: ParameterValues,
    kind: ParameterKind,
    name: &str,
    place: &SourcePlace,
    report: &Report,
) -> ParameterValues {
    let is_in_range = |v: &f64| v.abs() <= MAX_NUMBER;
    let whole = |v: &f64| v.fract() == 0.0 && v.abs() <= f64::from(i32::MAX);
    let allowed = match (kind, &values) {
        (_, ParameterValues::Broken) => return values,
        (_, ParameterValues::Numbers(none)) if none.is_empty() => return values,
        (_, ParameterValues::Numbers(all))
            if kind != ParameterKind::Integer && !all.iter().all(is_in_range) =>
        {
            "numbers from -1e9 to 1e9"
        }
        (ParameterKind::Bool, ParameterValues::Truths(_))
        | (
            ParameterKind::Text | ParameterKind::Texture | ParameterKind::Spectrum,
            ParameterValues::Texts(_),
        ) => return values,
        (ParameterKind::Integer, ParameterValues::Numbers(all)) if all.iter().all(whole) => {
            return values;
        }
        (ParameterKind::Bool, _) => "true or false, without quotation marks",
        (ParameterKind::Text | ParameterKind::Texture, _) => "words in quotation marks",
        (ParameterKind::Integer, _) => "integers of 32 bits",
        (_, ParameterValues::Numbers(all)) if all.len().is_multiple_of(kind.arity()) => {
            return values;
        }
        (ParameterKind::Spectrum, _) => "pairs of a wavelength and a value, or a name",
        (kind, _) => match kind.arity() {
            1 => "numbers",
            2 => "pairs of numbers",
            _ => "threes of numbers",
        },
    };
    let message = format!("{} {name}; allowed: {allowed}", kind.name());
    report.cause(place, message);
    ParameterValues::Broken
}
