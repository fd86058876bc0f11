//! Functions that read the properties of an object and mark them as read.

use super::index::named_index;
use super::object::{MitsubaObject, ObjectProperty, ObjectRef, Value};
use super::reader::MitsubaReader;
use super::xml::unknown;
use crate::report::{SourcePlace, keyword, quoted};
use etendue_world::Texture;
use glam::{DAffine3, DVec3};

impl MitsubaObject<'_> {
    /// The property with the given name. If several nested objects have the same name, the
    /// last of these objects counts, as in Mitsuba.
    pub(super) fn property(&self, name: &str) -> Option<&ObjectProperty> {
        let found = self.last(name)?;
        found.is_read.set(true);
        Some(found)
    }

    pub(super) fn has(&self, name: &str) -> bool {
        self.last(name).is_some()
    }

    /// The value of a property, as converted by `read`, or `None` if the property is
    /// missing, or if a cause of refusal was reported.
    fn ask<'v, T>(
        &'v self,
        name: &str,
        allowed: &str,
        read: impl Fn(&'v Value) -> Option<T>,
    ) -> Option<T> {
        let property = self.property(name)?;
        let value = read(&property.value);
        if value.is_none() && !matches!(property.value, Value::Broken) {
            let noun = property.value.noun();
            let message = format!("{name} is {noun}; allowed: {allowed}");
            self.report.cause(&property.place, message);
        }
        value
    }

    /// Adds a note at the object.
    pub(super) fn note(&self, message: impl Into<String>) {
        self.report.note(&self.place, message);
    }

    /// Adds a cause at the object.
    pub(super) fn cause(&self, message: impl Into<String>) {
        self.report.cause(&self.place, message);
    }

    /// Adds a cause at the object, and returns `None` in place of its value.
    pub(super) fn refuse<T>(&self, message: impl Into<String>) -> Option<T> {
        self.report.refuse(&self.place, message)
    }

    /// Adds a cause at a property.
    pub(super) fn cause_at(&self, name: &str, message: impl Into<String>) {
        self.report.cause(self.place_of(name), message);
    }

    /// Adds a cause at a property, and returns `None` in place of the property's value.
    pub(super) fn fault<T>(&self, name: &str, message: impl Into<String>) -> Option<T> {
        self.report.refuse(self.place_of(name), message)
    }

    pub(super) fn number(&self, name: &str) -> Option<f64> {
        self.ask(name, "a number", |value| match value {
            Value::Number(value) => Some(*value),
            Value::Whole(value) => Some(*value as f64),
            _ => None,
        })
    }

    /// Reads a number. A number outside of the range is a cause of refusal; its message states the
    /// range.
    pub(super) fn number_within(
        &self,
        name: &str,
        allowed: &str,
        is_allowed: impl Fn(f64) -> bool,
    ) -> Option<f64> {
        let value = self.number(name)?;
        if is_allowed(value) {
            return Some(value);
        }
        self.fault(name, format!("{name} is {value}; allowed: {allowed}"))
    }

    /// Reads a number like [`Self::number_within`], or returns `default` if the property is missing.
    pub(super) fn number_or(
        &self,
        name: &str,
        default: f64,
        allowed: &str,
        is_allowed: impl Fn(f64) -> bool,
    ) -> Option<f64> {
        match self.has(name) {
            true => self.number_within(name, allowed, is_allowed),
            false => Some(default),
        }
    }

    pub(super) fn whole(&self, name: &str) -> Option<i64> {
        self.ask(name, "an integer", |value| match value {
            Value::Whole(value) => Some(*value),
            _ => None,
        })
    }

    pub(super) fn truth(&self, name: &str) -> bool {
        let found = self.ask(name, "a boolean", |value| match value {
            Value::Truth(value) => Some(*value),
            _ => None,
        });
        found.unwrap_or(false)
    }

    pub(super) fn text(&self, name: &str) -> Option<&str> {
        self.ask(name, "a string", |value| match value {
            Value::Text(value) => Some(value.as_str()),
            _ => None,
        })
    }

    pub(super) fn vector(&self, name: &str) -> Option<DVec3> {
        self.ask(name, "a point or a vector", |value| match value {
            Value::Vector(value) => Some(*value),
            _ => None,
        })
    }

    pub(super) fn vector_or(&self, name: &str, default: DVec3) -> Option<DVec3> {
        match self.has(name) {
            true => self.vector(name),
            false => Some(default),
        }
    }

    pub(super) fn transform(&self, name: &str) -> Option<DAffine3> {
        self.ask(name, "a transform", |value| match value {
            Value::Transform(value) => Some(**value),
            _ => None,
        })
    }

    /// Reads one of several keywords; the first keyword is the default. Returns `None` if a cause
    /// of refusal was reported.
    pub(super) fn choice<T: Copy>(&self, name: &str, allowed: &[(&str, T)]) -> Option<T> {
        if !self.has(name) {
            return allowed.first().map(|(_, value)| *value);
        }
        let word = self.text(name)?.to_ascii_lowercase();
        let found = keyword(name, &word, allowed);
        self.report.accept(self.place_of(name), found)
    }

    /// Reads the property `filename` of an object.
    pub(super) fn file_name(&self) -> Option<&str> {
        if !self.has("filename") {
            self.cause(format!("{} without filename", quoted(&self.plugin)));
        }
        self.text("filename")
    }

    /// Reports a file that cannot be used, and returns `None` in place of its content.
    pub(super) fn unread<T>(&self, name: &str, error: &str) -> Option<T> {
        self.fault("filename", format!("file {} {error}", quoted(name)))
    }

    /// The index of refraction inside divided by the index outside. `inside` names the
    /// default material inside.
    pub(super) fn relative_index(&self, inside: &str) -> Option<f64> {
        let inside = self.one_index("int_ior", inside);
        let outside = self.one_index("ext_ior", "air");
        Some(inside? / outside?)
    }

    fn one_index(&self, name: &str, default: &str) -> Option<f64> {
        let word = match self.property(name).map(|p| &p.value) {
            None => default,
            Some(Value::Text(word)) => word,
            Some(_) => return self.number_within(name, "a number above 0", |v| v > 0.0),
        };
        named_index(word).or_else(|| {
            let word = quoted(word);
            self.fault(
                name,
                format!("{name}: no index of refraction is known for {word}"),
            )
        })
    }

    /// A texture, unless one of its values is below 0.
    pub(super) fn not_negative(&self, name: &str, texture: Texture) -> Option<Texture> {
        let lowest = texture.smallest();
        if lowest >= 0.0 {
            return Some(texture);
        }
        self.fault(
            name,
            format!("{name} goes down to {lowest}; allowed: 0 or more"),
        )
    }

    /// The position of a property in the file or, if the property is missing, the
    /// position of the object.
    pub(super) fn place_of(&self, name: &str) -> &SourcePlace {
        self.last(name).map_or(&self.place, |found| &found.place)
    }
}

impl<'a> MitsubaReader<'a> {
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

    /// The object that a property contains or refers to.
    pub(super) fn object_of(&self, property: &'a ObjectProperty) -> Option<ObjectRef<'a>> {
        match &property.value {
            Value::Object(at) => self.objects.get(*at),
            // A cause of refusal was already added for an unknown object.
            Value::Reference(id) => self.objects.get(*self.ids.get(id)?),
            _ => None,
        }
    }

    /// All objects of a kind within an object, in the order of the file. Each is returned
    /// with the property that holds it.
    pub(super) fn children(
        &self,
        object: ObjectRef<'a>,
        kind: &str,
    ) -> Vec<(&'a ObjectProperty, ObjectRef<'a>)> {
        let all = object.properties.iter();
        let found = all.filter_map(|property| Some((property, self.object_of(property)?)));
        let found: Vec<_> = found.filter(|(_, child)| child.kind == kind).collect();
        for (property, child) in &found {
            property.is_read.set(true);
            child.is_used.set(true);
        }
        found
    }

    /// The only child object of a kind, if one exists. A second child of the same kind is a
    /// cause of refusal.
    pub(super) fn child(&self, object: ObjectRef<'a>, kind: &str) -> Option<ObjectRef<'a>> {
        let found = self.children(object, kind);
        if let Some((second, _)) = found.get(1) {
            let plugin = quoted(&object.plugin);
            let message = format!("{plugin} has a second {kind}; allowed: one");
            self.report.cause(&second.place, message);
        }
        found.first().map(|(_, child)| *child)
    }
}
