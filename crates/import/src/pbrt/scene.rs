//! A scene as its files have it: what each directive makes, with the transforms and materials that hold for it.

use super::entity::Entity;
use super::parameter::PbrtParameter;
use crate::report::SourcePlace;
use glam::DAffine3;
use std::collections::BTreeMap;
use std::rc::Rc;

/// What all files of a scene make together.
#[derive(Debug, Default)]
pub(super) struct PbrtScene {
    /// The camera, and the map from the world to its coordinates.
    pub(super) camera: Option<(Entity, DAffine3)>,
    /// Film, Sampler, Integrator, PixelFilter and Accelerator: the last of each.
    pub(super) settings: BTreeMap<&'static str, Entity>,
    pub(super) materials: Vec<Entity>,
    /// Materials with a name, by their numbers.
    pub(super) named: BTreeMap<String, usize>,
    /// Textures by their name; `true` for those of a spectrum.
    pub(super) textures: BTreeMap<(bool, String), Entity>,
    pub(super) areas: Vec<Entity>,
    pub(super) lights: Vec<(Entity, DAffine3)>,
    pub(super) shapes: Vec<PbrtShape>,
    pub(super) objects: BTreeMap<String, PbrtObject>,
    pub(super) instances: Vec<Instance>,
    /// Parameters of `Attribute` directives.
    pub(super) defaults: Vec<Rc<PbrtParameter>>,
}

/// A shape with all that holds for it.
#[derive(Debug)]
pub(super) struct PbrtShape {
    pub(super) entity: Entity,
    pub(super) to_world: DAffine3,
    /// `ReverseOrientation`
    pub(super) is_reversed: bool,
    pub(super) material: MaterialOf,
    /// The number of its area light.
    pub(super) area: Option<usize>,
}

/// The material of a shape.
#[derive(Clone, Debug)]
pub(super) enum MaterialOf {
    /// Where none is named.
    Default,
    Number(usize),
    /// With the place where it is asked for.
    Named(Rc<str>, SourcePlace),
}

/// What `ObjectBegin` and `ObjectEnd` enclose.
#[derive(Debug)]
pub(super) struct PbrtObject {
    pub(super) place: SourcePlace,
    pub(super) shapes: Vec<PbrtShape>,
}

/// An object that is shown.
#[derive(Debug)]
pub(super) struct Instance {
    pub(super) name: String,
    pub(super) place: SourcePlace,
    pub(super) to_world: DAffine3,
}

/// What directives leave for those after them.
#[derive(Clone, Debug)]
pub(super) struct GraphicsState {
    pub(super) to_world: DAffine3,
    pub(super) is_reversed: bool,
    pub(super) material: MaterialOf,
    pub(super) area: Option<usize>,
    /// Parameters for shapes, lights, materials, media and textures.
    pub(super) defaults: [Rc<Vec<Rc<PbrtParameter>>>; 5],
}

impl Default for GraphicsState {
    fn default() -> Self {
        Self {
            to_world: DAffine3::IDENTITY,
            is_reversed: false,
            material: MaterialOf::Default,
            area: None,
            defaults: Default::default(),
        }
    }
}
