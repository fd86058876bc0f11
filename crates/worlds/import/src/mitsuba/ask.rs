//! Functions that read the properties of an object and mark them as read.

use super::object::{MitsubaObject, ObjectProperty, Value};
use super::reader::MitsubaReader;
use super::xml::unknown;
use crate::report::{SourcePlace, quoted};
use glam::{DAffine3, DVec3};

impl<'a> MitsubaReader<'a> {
    /// Returns the property with the given name. If several nested objects have the same name, the
    /// last of these objects counts, as in Mitsuba.
    pub(super) fn property(
        &self,
        object: &'a MitsubaObject,
        name: &str,
    ) -> Option<&'a ObjectProperty> {
        let found = object.last(name)?;
        found.is_read.set(true);
        Some(found)
    }

    pub(super) fn has(&self, object: &MitsubaObject, name: &str) -> bool {
        object.last(name).is_some()
    }

    /// Returns the value of a property, as converted by `read`, or `None` if the property is
    /// missing, or if a cause of refusal was reported.
    fn ask<T>(
        &self,
        object: &'a MitsubaObject,
        name: &str,
        allowed: &str,
        read: impl Fn(&'a Value) -> Option<T>,
    ) -> Option<T> {
        let property = self.property(object, name)?;
        let value = read(&property.value);
        if value.is_none() && !matches!(property.value, Value::Broken) {
            let noun = property.value.noun();
            let message = format!("{name} is {noun}; allowed: {allowed}");
            self.report.cause(&property.place, message);
        }
        value
    }

    /// Adds a cause at a property, and returns `None` in place of the property's value.
    pub(super) fn fault<T>(
        &self,
        object: &'a MitsubaObject,
        name: &str,
        message: impl Into<String>,
    ) -> Option<T> {
        self.report.refuse(self.place_of(object, name), message)
    }

    pub(super) fn number(&self, object: &'a MitsubaObject, name: &str) -> Option<f64> {
        self.ask(object, name, "a number", |value| match value {
            Value::Number(value) => Some(*value),
            Value::Whole(value) => Some(*value as f64),
            _ => None,
        })
    }

    /// Reads a number. A number outside of the range is a cause of refusal; its message states the
    /// range.
    pub(super) fn number_within(
        &self,
        object: &'a MitsubaObject,
        name: &str,
        allowed: &str,
        is_allowed: impl Fn(f64) -> bool,
    ) -> Option<f64> {
        let value = self.number(object, name)?;
        if is_allowed(value) {
            return Some(value);
        }
        let message = format!("{name} is {value}; allowed: {allowed}");
        self.fault(object, name, message)
    }

    /// Reads a number like [`Self::number_within`], or returns `default` if the property is missing.
    pub(super) fn number_or(
        &self,
        object: &'a MitsubaObject,
        name: &str,
        default: f64,
        allowed: &str,
        is_allowed: impl Fn(f64) -> bool,
    ) -> Option<f64> {
        match self.has(object, name) {
            true => self.number_within(object, name, allowed, is_allowed),
            false => Some(default),
        }
    }

    pub(super) fn whole(&self, object: &'a MitsubaObject, name: &str) -> Option<i64> {
        self.ask(object, name, "an integer", |value| match value {
            Value::Whole(value) => Some(*value),
            _ => None,
        })
    }

    pub(super) fn truth(&self, object: &'a MitsubaObject, name: &str) -> bool {
        let found = self.ask(object, name, "a boolean", |value| match value {
            Value::Truth(value) => Some(*value),
            _ => None,
        });
        found.unwrap_or(false)
    }

    pub(super) fn text(&self, object: &'a MitsubaObject, name: &str) -> Option<&'a str> {
        self.ask(object, name, "a string", |value| match value {
            Value::Text(value) => Some(value.as_str()),
            _ => None,
        })
    }

    pub(super) fn vector(&self, object: &'a MitsubaObject, name: &str) -> Option<DVec3> {
        self.ask(object, name, "a point or a vector", |value| match value {
            Value::Vector(value) => Some(*value),
            _ => None,
        })
    }

    pub(super) fn transform(&self, object: &'a MitsubaObject, name: &str) -> Option<DAffine3> {
        self.ask(object, name, "a transform", |value| match value {
            Value::Transform(value) => Some(**value),
            _ => None,
        })
    }

    /// Returns the position of a property in the file or, if the property is missing, the
    /// position of the object.
    pub(super) fn place_of(&self, object: &'a MitsubaObject, name: &str) -> &'a SourcePlace {
        object
            .last(name)
            .map_or(&object.place, |found| &found.place)
    }

    /// Adds a cause for each reference to an unknown object.
    pub(super) fn refuse_unknown(&self) {
        for property in self.objects.iter().flat_map(|object| &object.properties) {
            if let Value::Reference(id) = &property.value
                && !self.ids.contains_key(id)
            {
                property.is_read.set(true);
                self.report.cause(&property.place, unknown(id));
            }
        }
    }

    /// Returns the object that a property contains or refers to.
    pub(super) fn object_of(&self, property: &'a ObjectProperty) -> Option<&'a MitsubaObject> {
        match &property.value {
            Value::Object(at) => self.objects.get(*at),
            // A cause of refusal was already added for an unknown object.
            Value::Reference(id) => self.objects.get(*self.ids.get(id)?),
            _ => None,
        }
    }

    /// Returns all objects of a kind within an object, in the order of the file. Each is returned
    /// with the property that holds it.
    pub(super) fn children(
        &self,
        object: &'a MitsubaObject,
        kind: &str,
    ) -> Vec<(&'a ObjectProperty, &'a MitsubaObject)> {
        let all = object.properties.iter();
        let found = all.filter_map(|property| Some((property, self.object_of(property)?)));
        let found: Vec<_> = found.filter(|(_, child)| child.kind == kind).collect();
        for (property, child) in &found {
            property.is_read.set(true);
            child.is_used.set(true);
        }
        found
    }

    /// Returns the only child object of a kind, if one exists. A second child of the same kind is a
    /// cause of refusal.
    pub(super) fn child(&self, object: &'a MitsubaObject, kind: &str) -> Option<&'a MitsubaObject> {
        let found = self.children(object, kind);
        if let Some((second, _)) = found.get(1) {
            let plugin = quoted(&object.plugin);
            let message = format!("{plugin} has a second {kind}; allowed: one");
            self.report.cause(&second.place, message);
        }
        found.first().map(|(_, child)| *child)
    }
}
