//! Objects, properties and values of a Mitsuba scene.

use crate::report::SourcePlace;
use glam::{DAffine3, DVec3};
use std::cell::Cell;
use std::path::PathBuf;
use std::rc::Rc;

/// An object of the scene: what Mitsuba has a plugin for.
#[derive(Debug)]
pub(super) struct MitsubaObject {
    pub(super) kind: ObjectKind,
    /// Its number among all objects.
    pub(super) number: usize,
    /// The name of the plugin.
    pub(super) plugin: String,
    pub(super) id: Option<String>,
    pub(super) place: SourcePlace,
    /// Where its files are looked for.
    pub(super) folders: Rc<[PathBuf]>,
    /// In the order of the file.
    pub(super) properties: Vec<ObjectProperty>,
    /// The object that it is written in; the scene's is its own.
    pub(super) parent: usize,
    /// Whether the world has it.
    pub(super) is_used: Cell<bool>,
}

/// A value or an object within another one.
#[derive(Debug)]
pub(super) struct ObjectProperty {
    /// Empty for objects without a name.
    pub(super) name: String,
    pub(super) value: Value,
    pub(super) place: SourcePlace,
    /// Whether anything asked for it.
    pub(super) is_read: Cell<bool>,
}

/// What a property is.
#[derive(Clone, Debug)]
pub(super) enum Value {
    Number(f64),
    Whole(i64),
    Truth(bool),
    Text(String),
    Vector(DVec3),
    Color([f64; 3]),
    /// A spectrum with one number.
    Uniform(f64),
    /// Pairs of a wavelength, nm, and a value.
    Spectrum(Rc<[[f64; 2]]>),
    Transform(DAffine3),
    /// An object written here, by its number.
    Object(usize),
    /// An object written elsewhere, by its id.
    Reference(String),
    /// A cause has been given.
    Broken,
}

/// Elements that are objects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ObjectKind {
    Scene,
    Integrator,
    Sensor,
    Film,
    Sampler,
    Rfilter,
    Bsdf,
    Texture,
    Emitter,
    Shape,
    Medium,
    Phase,
    Volume,
}

impl ObjectKind {
    /// The kind of an element's name. A spectrum with a type is a texture.
    pub(super) fn of(name: &str, has_type: bool) -> Option<Self> {
        Some(match name {
            "scene" => Self::Scene,
            "integrator" => Self::Integrator,
            "sensor" => Self::Sensor,
            "film" => Self::Film,
            "sampler" => Self::Sampler,
            "rfilter" => Self::Rfilter,
            "bsdf" => Self::Bsdf,
            "texture" => Self::Texture,
            "spectrum" if has_type => Self::Texture,
            "emitter" => Self::Emitter,
            "shape" => Self::Shape,
            "medium" => Self::Medium,
            "phase" => Self::Phase,
            "volume" => Self::Volume,
            _ => return None,
        })
    }

    /// Its name in the file.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Scene => "scene",
            Self::Integrator => "integrator",
            Self::Sensor => "sensor",
            Self::Film => "film",
            Self::Sampler => "sampler",
            Self::Rfilter => "rfilter",
            Self::Bsdf => "bsdf",
            Self::Texture => "texture",
            Self::Emitter => "emitter",
            Self::Shape => "shape",
            Self::Medium => "medium",
            Self::Phase => "phase",
            Self::Volume => "volume",
        }
    }
}

impl Value {
    /// What it is, for messages.
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
