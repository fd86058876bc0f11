//! Entities that directives define. A parameter of an entity is marked when it is read.

use super::parameter::{ParameterKind, ParameterValues, PbrtParameter};
use crate::report::{Report, SourcePlace, quoted};
use glam::{DVec2, DVec3};
use std::cell::Cell;
use std::rc::Rc;

/// The error of a function that has already added a cause of refusal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct CauseGiven;

/// A value that was read, or an error if a cause of refusal was reported.
pub(super) type Read<T> = Result<T, CauseGiven>;

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
    /// Returns the last parameter with the given name among the parameters of the entity, or else
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

    /// Returns the position of a parameter in the file or, if the parameter is missing, the
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
        self.refuse(format!(
            "{kind} {plugin} is not supported; allowed: {allowed}"
        ))
    }

    /// Marks all parameters as read, after a message that covers all of them.
    pub(super) fn drop_all(&self) {
        self.is_used.set(true);
        for parameter in &self.own {
            parameter.is_read.set(true);
        }
    }

    /// Returns the values of a parameter, which must have one of the given types, or `None` if
    /// the parameter is missing.
    fn values(&self, name: &str, kinds: &[ParameterKind]) -> Read<Option<&ParameterValues>> {
        let Some(parameter) = self.find(name) else {
            return Ok(None);
        };
        if let ParameterValues::Broken = parameter.values {
            return Err(CauseGiven);
        }
        if kinds.contains(&parameter.kind) {
            return Ok(Some(&parameter.values));
        }
        let names: Vec<&str> = kinds.iter().map(|kind| kind.name()).collect();
        let (kind, names) = (parameter.kind.name(), names.join(", "));
        let message = format!("{name} is of type {kind}; allowed: {names}");
        Err(self.fault(name, message))
    }

    /// Reads all numbers of a parameter.
    pub(super) fn numbers(&self, name: &str, kinds: &[ParameterKind]) -> Read<&[f64]> {
        match self.values(name, kinds)? {
            Some(ParameterValues::Numbers(all)) => Ok(all),
            _ => Ok(&[]),
        }
    }

    /// Reads the `N` numbers of a parameter, if it exists.
    pub(super) fn exactly<const N: usize>(
        &self,
        name: &str,
        kind: ParameterKind,
    ) -> Read<Option<[f64; N]>> {
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
        let one = self.exactly::<1>(name, ParameterKind::Float)?;
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
            false => {
                let message = format!("{name} is {value}; allowed: {allowed}");
                Err(self.fault(name, message))
            }
        }
    }

    #[expect(clippy::cast_possible_truncation, reason = "integers fit 32 bits")]
    pub(super) fn integer_or(&self, name: &str, default: i64) -> Read<i64> {
        let one = self.exactly::<1>(name, ParameterKind::Integer)?;
        Ok(one.map_or(default, |[value]| value as i64))
    }

    pub(super) fn truth(&self, name: &str, default: bool) -> Read<bool> {
        match self.values(name, &[ParameterKind::Bool])? {
            None => Ok(default),
            Some(ParameterValues::Truths(all)) if all.len() == 1 => Ok(all[0]),
            Some(_) => Err(self.fault(name, format!("{name} is not one boolean"))),
        }
    }

    /// Reads all strings of a parameter.
    pub(super) fn texts(&self, name: &str) -> Read<&[String]> {
        match self.values(name, &[ParameterKind::Text])? {
            Some(ParameterValues::Texts(all)) => Ok(all),
            _ => Ok(&[]),
        }
    }

    /// Reads the name of the texture in a parameter of type texture.
    pub(super) fn texture_name(&self, name: &str) -> Read<&str> {
        match self.values(name, &[ParameterKind::Texture])? {
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
        let word = self.text(name)?;
        let found = allowed
            .iter()
            .find(|(known, _)| word.is_none_or(|word| word == *known));
        found.map(|(_, value)| *value).ok_or_else(|| {
            let words: Vec<&str> = allowed.iter().map(|(known, _)| *known).collect();
            let word = quoted(word.unwrap_or_default());
            let message = format!("{name} is {word}; allowed: {}", words.join(", "));
            self.fault(name, message)
        })
    }

    pub(super) fn point_or(&self, name: &str, default: DVec3) -> Read<DVec3> {
        let found = self.exactly::<3>(name, ParameterKind::Point3)?;
        Ok(found.map_or(default, DVec3::from))
    }

    pub(super) fn points(&self, name: &str, kind: ParameterKind) -> Read<Vec<DVec3>> {
        let all = self.numbers(name, &[kind])?.chunks_exact(3);
        Ok(all.map(DVec3::from_slice).collect())
    }

    pub(super) fn pairs(&self, name: &str) -> Read<Vec<DVec2>> {
        let kinds = [ParameterKind::Point2, ParameterKind::Vector2];
        let all = self.numbers(name, &kinds)?.chunks_exact(2);
        Ok(all.map(DVec2::from_slice).collect())
    }
}
