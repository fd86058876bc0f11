//! Notes on unused parameters and objects.

use super::entity::Entity;
use super::parameter::PbrtParameter;
use super::scene::PbrtScene;
use crate::report::{Report, quoted};
use std::collections::BTreeSet;
use std::rc::Rc;

/// Adds a note for each parameter that was not read, and for each object that is not in the world.
pub(super) fn tell(scene: &PbrtScene<'_>, report: &Report) {
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
            report.note(
                &object.place,
                format!("object {} is not used", quoted(name)),
            );
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
