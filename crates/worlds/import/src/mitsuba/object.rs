//! Objects, properties and values of a Mitsuba scene, and notes on those that are not used.

use crate::report::{Report, SourcePlace, quoted};
use glam::{DAffine3, DVec3};
use std::cell::Cell;
use std::path::PathBuf;
use std::rc::Rc;

/// An object of the scene, which Mitsuba creates by a plugin.
#[derive(Debug)]
pub(super) struct MitsubaObject<'a> {
    /// Where causes and notes are added.
    pub(super) report: &'a Report,
    /// The name of its element.
    pub(super) kind: &'static str,
    /// The index of the object among all objects.
    pub(super) number: usize,
    /// The name of the plugin.
    pub(super) plugin: String,
    pub(super) id: Option<String>,
    pub(super) place: SourcePlace,
    /// The search folders of the object.
    pub(super) folders: Rc<[PathBuf]>,
    /// The properties in the order of the file.
    pub(super) properties: Vec<ObjectProperty>,
    /// The index of the enclosing object; the scene is its own parent.
    pub(super) parent: usize,
    /// Whether the world uses the object.
    pub(super) is_used: Cell<bool>,
}

/// An object of the scene, for as long as the scene is read.
pub(super) type ObjectRef<'a> = &'a MitsubaObject<'a>;

/// A property of an object: a value, or another object.
#[derive(Debug)]
pub(super) struct ObjectProperty {
    /// The name of the property; empty for an object without a name.
    pub(super) name: String,
    pub(super) value: Value,
    pub(super) place: SourcePlace,
    /// Whether the property was read.
    pub(super) is_read: Cell<bool>,
}

/// The value of a property.
#[derive(Clone, Debug)]
pub(super) enum Value {
    Number(f64),
    Whole(i64),
    Truth(bool),
    Text(String),
    Vector(DVec3),
    Color([f64; 3]),
    /// A spectrum given by one number.
    Uniform(f64),
    /// Pairs of a wavelength, nm, and a value.
    Spectrum(Rc<[[f64; 2]]>),
    /// The map is in a box, because it is much larger than other values.
    Transform(Box<DAffine3>),
    /// The index of an object that is defined within the property.
    Object(usize),
    /// The id of an object that is defined elsewhere.
    Reference(String),
    /// An invalid value, for which a cause was added.
    Broken,
}

impl MitsubaObject<'_> {
    /// The kind and the plugin of the object, for messages.
    pub(super) fn title(&self) -> String {
        format!("{} {}", self.kind, quoted(&self.plugin))
    }

    /// The property with the given name, the last one if there are several.
    pub(super) fn last(&self, name: &str) -> Option<&ObjectProperty> {
        self.properties
            .iter()
            .rfind(|property| property.name == name)
    }
}

/// The names of elements that define objects.
const KINDS: [&str; 13] = [
    "scene",
    "integrator",
    "sensor",
    "film",
    "sampler",
    "rfilter",
    "bsdf",
    "texture",
    "emitter",
    "shape",
    "medium",
    "phase",
    "volume",
];

/// The kind of object that an element of this name defines. A spectrum with a type is a
/// texture.
pub(super) fn kind_of(name: &str, has_type: bool) -> Option<&'static str> {
    let name = if name == "spectrum" && has_type {
        "texture"
    } else {
        name
    };
    KINDS.into_iter().find(|kind| *kind == name)
}

impl Value {
    /// A noun that names the kind of the value in messages.
    pub(super) fn noun(&self) -> &'static str {
        match self {
            Self::Number(_) => "a number",
            Self::Whole(_) => "an integer",
            Self::Truth(_) => "a boolean",
            Self::Text(_) => "a string",
            Self::Vector(_) => "a vector",
            Self::Color(_) => "a colour",
            Self::Uniform(_) | Self::Spectrum(_) => "a spectrum",
            Self::Transform(_) => "a transform",
            Self::Object(_) | Self::Reference(_) => "an object",
            Self::Broken => "unsound",
        }
    }
}

/// Adds a note for each property that was not read, and for each object that is not in the world.
pub(super) fn tell_unused(objects: &[MitsubaObject<'_>]) {
    for (at, object) in objects.iter().enumerate() {
        if object.is_used.get() {
            properties(object);
        } else if at != object.parent && objects[object.parent].is_used.get() {
            // One note suffices for an unused object and all objects that it contains.
            let id = object.id.as_deref().map(|id| format!(" {}", quoted(id)));
            let id = id.unwrap_or_default();
            object.note(format!("{}{id} is not used", object.title()));
        }
    }
}

fn properties(object: &MitsubaObject<'_>) {
    for property in object.properties.iter().filter(|p| !p.is_read.get()) {
        if let Value::Object(_) = property.value {
            continue;
        }
        let title = object.title();
        let message = match &property.value {
            Value::Reference(id) => format!("reference to {} in {title} is left out", quoted(id)),
            _ => format!("{} of {title} is left out", quoted(&property.name)),
        };
        object.report.note(&property.place, message);
    }
}
