//! A scene as its files describe it: the entity that each directive defines, with its transform
//! and material; and notes on what is not used.

use super::entity::{Entity, PbrtParameter};
use crate::report::{Report, SourcePlace, quoted};
use glam::DAffine3;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

/// The scene described by all files together.
#[derive(Debug, Default)]
pub(super) struct PbrtScene<'a> {
    /// The camera, and the map from world to camera coordinates.
    pub(super) camera: Option<(Entity<'a>, DAffine3)>,
    /// The last entity of each of the directives Film, Sampler, Integrator, PixelFilter and
    /// Accelerator.
    pub(super) settings: BTreeMap<&'static str, Entity<'a>>,
    pub(super) materials: Vec<Entity<'a>>,
    /// Named materials, by index.
    pub(super) named: BTreeMap<String, usize>,
    /// Textures by name; the flag is `true` for spectrum textures.
    pub(super) textures: BTreeMap<(bool, String), Entity<'a>>,
    pub(super) areas: Vec<Entity<'a>>,
    pub(super) lights: Vec<(Entity<'a>, DAffine3)>,
    pub(super) shapes: Vec<PbrtShape<'a>>,
    pub(super) objects: BTreeMap<String, PbrtObject<'a>>,
    pub(super) instances: Vec<Instance>,
    /// Parameters of `Attribute` directives.
    pub(super) defaults: Vec<Rc<PbrtParameter>>,
}

/// A shape with the graphics state in which it was defined.
#[derive(Debug)]
pub(super) struct PbrtShape<'a> {
    pub(super) entity: Entity<'a>,
    pub(super) to_world: DAffine3,
    /// `ReverseOrientation`
    pub(super) is_reversed: bool,
    pub(super) material: MaterialOf,
    /// The index of the shape's area light.
    pub(super) area: Option<usize>,
}

/// The material of a shape.
#[derive(Clone, Debug, Default)]
pub(super) enum MaterialOf {
    /// The default material.
    #[default]
    Default,
    Number(usize),
    /// A named material, with the place of the reference.
    Named(Rc<str>, SourcePlace),
}

/// An object defined between `ObjectBegin` and `ObjectEnd`.
#[derive(Debug)]
pub(super) struct PbrtObject<'a> {
    pub(super) place: SourcePlace,
    pub(super) shapes: Vec<PbrtShape<'a>>,
}

/// An instance of an object.
#[derive(Debug)]
pub(super) struct Instance {
    pub(super) name: String,
    pub(super) place: SourcePlace,
    pub(super) to_world: DAffine3,
}

/// The graphics state.
#[derive(Clone, Debug, Default)]
pub(super) struct GraphicsState {
    pub(super) to_world: DAffine3,
    pub(super) is_reversed: bool,
    pub(super) material: MaterialOf,
    pub(super) area: Option<usize>,
    /// Default parameters for shapes, lights, materials, media and textures.
    pub(super) defaults: [Rc<Vec<Rc<PbrtParameter>>>; 5],
}

/// Adds a note for each parameter that was not read, and for each object that is not in the world.
pub(super) fn tell_unused(scene: &PbrtScene<'_>, report: &Report) {
    let camera = scene.camera.iter().map(|(camera, _)| camera);
    let lights = scene.lights.iter().map(|(light, _)| light);
    let all = camera
        .chain(scene.settings.values())
        .chain(&scene.materials)
        .chain(scene.textures.values())
        .chain(lights)
        .chain(&scene.areas)
        .chain(scene.shapes.iter().map(|shape| &shape.entity));
    all.for_each(|entity| entity_left(entity, report));
    let shown: BTreeSet<&str> = scene.instances.iter().map(|i| i.name.as_str()).collect();
    for (name, object) in &scene.objects {
        let shapes = object.shapes.iter().map(|shape| &shape.entity);
        if object.shapes.iter().any(|shape| shape.entity.is_used.get()) {
            shapes.for_each(|entity| entity_left(entity, report));
        } else if !shown.contains(name.as_str()) {
            let message = format!("object {} is not used", quoted(name));
            report.note(&object.place, message);
        }
    }
    parameters(&scene.defaults, "attributes", report);
}

fn entity_left(entity: &Entity<'_>, report: &Report) {
    let plugin = quoted(&entity.plugin);
    let name = match entity.plugin.as_str() {
        "" => entity.kind.to_owned(),
        _ => format!("{} {plugin}", entity.kind),
    };
    match entity.is_used.get() {
        true => parameters(&entity.own, &name, report),
        false => report.note(&entity.place, format!("{name} is not used")),
    }
}

fn parameters(all: &[Rc<PbrtParameter>], of: &str, report: &Report) {
    for parameter in all.iter().filter(|p| !p.is_read.get()) {
        let name = quoted(&parameter.name);
        report.note(&parameter.place, format!("{name} of {of} is left out"));
    }
}
