//! Entities that directives define, with their parameters, such as `"float radius" 2`. A parameter
//! of an entity is marked when it is read.

use super::token::{Token, Tokens, number};
use crate::range::MAX_NUMBER;
use crate::report::{Report, SourcePlace, keyword, quoted};
use glam::{DVec2, DVec3};
use std::cell::Cell;
use std::rc::Rc;

/// A value that was read, or an error if a cause of refusal was reported.
pub(super) type Read<T> = Result<T, CauseGiven>;

/// The parameter types of pbrt-v4, each with the number of numbers that one value has.
const KINDS: [(&str, usize); 13] = [
    ("bool", 1),
    ("integer", 1),
    ("float", 1),
    ("point2", 2),
    ("vector2", 2),
    ("point3", 3),
    ("vector3", 3),
    ("normal", 3),
    ("string", 1),
    ("texture", 1),
    ("rgb", 3),
    ("blackbody", 1),
    ("spectrum", 1),
];

/// The error of a function that has already added a cause of refusal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct CauseGiven;

/// A camera, light, shape or other entity that pbrt implements by a plugin.
#[derive(Clone, Debug)]
pub(super) struct Entity<'a> {
    /// Where causes of refusal are added.
    pub(super) report: &'a Report,
    /// The name of the directive.
    pub(super) kind: &'static str,
    /// The name of the plugin.
    pub(super) plugin: String,
    pub(super) place: SourcePlace,
    /// Its own parameters.
    pub(super) own: Vec<Rc<PbrtParameter>>,
    /// Default parameters from preceding `Attribute` directives.
    pub(super) defaults: Rc<Vec<Rc<PbrtParameter>>>,
    /// Whether the world uses the entity.
    pub(super) is_used: Cell<bool>,
}

impl Entity<'_> {
    /// The last parameter with the given name among the parameters of the entity, or else
    /// among the default parameters.
    pub(super) fn find(&self, name: &str) -> Option<&PbrtParameter> {
        let all = self.own.iter().rev().chain(self.defaults.iter().rev());
        let found = all.map(|p| &**p).find(|p| p.name == name)?;
        found.is_read.set(true);
        Some(found)
    }

    pub(super) fn has(&self, name: &str) -> bool {
        self.find(name).is_some()
    }

    /// The position of a parameter in the file or, if the parameter is missing, the
    /// position of the directive.
    pub(super) fn place_of(&self, name: &str) -> &SourcePlace {
        self.find(name).map_or(&self.place, |p| &p.place)
    }

    /// Adds a cause at a parameter.
    pub(super) fn fault(&self, name: &str, message: impl Into<String>) -> CauseGiven {
        self.report.cause(self.place_of(name), message);
        CauseGiven
    }

    /// Adds a cause at the directive.
    pub(super) fn refuse(&self, message: impl Into<String>) -> CauseGiven {
        self.report.cause(&self.place, message);
        CauseGiven
    }

    /// Adds a cause that lists the supported plugins.
    pub(super) fn unsupported(&self, allowed: &str) -> CauseGiven {
        let plugin = quoted(&self.plugin);
        let kind = self.kind;
        self.drop_all();
        let message = format!("{kind} {plugin} is not supported; allowed: {allowed}");
        self.refuse(message)
    }

    /// Marks all parameters as read, after a message that covers all of them.
    pub(super) fn drop_all(&self) {
        self.is_used.set(true);
        for parameter in &self.own {
            parameter.is_read.set(true);
        }
    }

    /// The values of a parameter, which must have one of the given types, or `None` if
    /// the parameter is missing.
    fn values(&self, name: &str, kinds: &[&str]) -> Read<Option<&ParameterValues>> {
        let Some(parameter) = self.find(name) else {
            return Ok(None);
        };
        if let ParameterValues::Broken = parameter.values {
            return Err(CauseGiven);
        }
        if kinds.contains(&parameter.kind) {
            return Ok(Some(&parameter.values));
        }
        let (kind, names) = (parameter.kind, kinds.join(", "));
        Err(self.fault(name, format!("{name} is of type {kind}; allowed: {names}")))
    }

    /// Reads all numbers of a parameter.
    pub(super) fn numbers(&self, name: &str, kinds: &[&str]) -> Read<&[f64]> {
        match self.values(name, kinds)? {
            Some(ParameterValues::Numbers(all)) => Ok(all),
            _ => Ok(&[]),
        }
    }

    /// Reads the `N` numbers of a parameter, if it exists.
    pub(super) fn exactly<const N: usize>(&self, name: &str, kind: &str) -> Read<Option<[f64; N]>> {
        if !self.has(name) {
            return Ok(None);
        }
        let all = self.numbers(name, &[kind])?;
        match <[f64; N]>::try_from(all) {
            Ok(numbers) => Ok(Some(numbers)),
            Err(_) => {
                let message = format!("{name} has {} numbers; allowed: {N}", all.len());
                Err(self.fault(name, message))
            }
        }
    }

    pub(super) fn float(&self, name: &str) -> Read<Option<f64>> {
        let one = self.exactly::<1>(name, "float")?;
        Ok(one.map(|[value]| value))
    }

    pub(super) fn float_or(&self, name: &str, default: f64) -> Read<f64> {
        Ok(self.float(name)?.unwrap_or(default))
    }

    /// Reads a number. A number outside of the range is a cause of refusal; its message states the
    /// range.
    pub(super) fn float_within(
        &self,
        name: &str,
        default: f64,
        allowed: &str,
        is_allowed: impl Fn(f64) -> bool,
    ) -> Read<f64> {
        let value = self.float_or(name, default)?;
        match is_allowed(value) {
            true => Ok(value),
            false => Err(self.fault(name, format!("{name} is {value}; allowed: {allowed}"))),
        }
    }

    #[expect(clippy::cast_possible_truncation, reason = "integers fit 32 bits")]
    pub(super) fn integer_or(&self, name: &str, default: i64) -> Read<i64> {
        let one = self.exactly::<1>(name, "integer")?;
        Ok(one.map_or(default, |[value]| value as i64))
    }

    pub(super) fn truth(&self, name: &str, default: bool) -> Read<bool> {
        match self.values(name, &["bool"])? {
            None => Ok(default),
            Some(ParameterValues::Truths(all)) if all.len() == 1 => Ok(all[0]),
            Some(_) => Err(self.fault(name, format!("{name} is not one boolean"))),
        }
    }

    /// Reads all strings of a parameter.
    pub(super) fn texts(&self, name: &str) -> Read<&[String]> {
        match self.values(name, &["string"])? {
            Some(ParameterValues::Texts(all)) => Ok(all),
            _ => Ok(&[]),
        }
    }

    /// Reads the name of the texture in a parameter of type texture.
    pub(super) fn texture_name(&self, name: &str) -> Read<&str> {
        match self.values(name, &["texture"])? {
            Some(ParameterValues::Texts(all)) if all.len() == 1 => Ok(&all[0]),
            _ => Err(self.fault(name, format!("{name} is not one texture"))),
        }
    }

    /// Reads the only string of a parameter, if it exists.
    pub(super) fn text(&self, name: &str) -> Read<Option<&str>> {
        match self.texts(name)? {
            [] if !self.has(name) => Ok(None),
            [one] => Ok(Some(one)),
            _ => Err(self.fault(name, format!("{name} is not one string"))),
        }
    }

    /// Reads one of several keywords, of which the first is the default.
    pub(super) fn choice<T: Copy>(&self, name: &str, allowed: &[(&str, T)]) -> Read<T> {
        let default = allowed.first().map(|(word, _)| *word);
        let word = self.text(name)?.or(default).unwrap_or_default();
        keyword(name, word, allowed).map_err(|message| self.fault(name, message))
    }

    pub(super) fn point_or(&self, name: &str, default: DVec3) -> Read<DVec3> {
        let found = self.exactly::<3>(name, "point3")?;
        Ok(found.map_or(default, DVec3::from))
    }

    pub(super) fn points(&self, name: &str, kind: &str) -> Read<Vec<DVec3>> {
        let all = self.numbers(name, &[kind])?.chunks_exact(3);
        Ok(all.map(DVec3::from_slice).collect())
    }

    pub(super) fn pairs(&self, name: &str) -> Read<Vec<DVec2>> {
        let kinds = ["point2", "vector2"];
        let all = self.numbers(name, &kinds)?.chunks_exact(2);
        Ok(all.map(DVec2::from_slice).collect())
    }
}

/// A named value.
#[derive(Debug)]
pub(super) struct PbrtParameter {
    /// The name of the type.
    pub(super) kind: &'static str,
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
        let Some((kind, arity)) = KINDS.iter().find(|(known, _)| *known == kind) else {
            let known = KINDS.map(|(known, _)| known).join(", ");
            let message = format!("a parameter has type {}; allowed: {known}", quoted(kind));
            report.cause(&place, message);
            continue;
        };
        all.push(Rc::new(PbrtParameter {
            values: checked(values, (kind, *arity), name, &place, report),
            kind,
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

/// The values if they match the type; otherwise adds a cause of refusal.
fn checked(
    values: ParameterValues,
    (kind, arity): (&str, usize),
    name: &str,
    place: &SourcePlace,
    report: &Report,
) -> ParameterValues {
    let is_in_range = |v: &f64| v.abs() <= MAX_NUMBER;
    let whole = |v: &f64| v.fract() == 0.0 && v.abs() <= f64::from(i32::MAX);
    let allowed = match (kind, &values) {
        (_, ParameterValues::Broken) => return values,
        (_, ParameterValues::Numbers(none)) if none.is_empty() => return values,
        (_, ParameterValues::Numbers(all)) if kind != "integer" && !all.iter().all(is_in_range) => {
            "numbers from -1e9 to 1e9"
        }
        ("bool", ParameterValues::Truths(_))
        | ("string" | "texture" | "spectrum", ParameterValues::Texts(_)) => return values,
        ("integer", ParameterValues::Numbers(all)) if all.iter().all(whole) => return values,
        ("bool", _) => "true or false, without quotation marks",
        ("string" | "texture", _) => "words in quotation marks",
        ("integer", _) => "integers of 32 bits",
        (_, ParameterValues::Numbers(all)) if all.len().is_multiple_of(arity) => return values,
        ("spectrum", _) => "pairs of a wavelength and a value, or a name",
        _ => match arity {
            1 => "numbers",
            2 => "pairs of numbers",
            _ => "threes of numbers",
        },
    };
    report.cause(place, format!("{kind} {name}; allowed: {allowed}"));
    ParameterValues::Broken
}
