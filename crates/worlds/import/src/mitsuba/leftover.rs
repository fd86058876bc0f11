//! Notes on unused properties and objects.

use super::object::{MitsubaObject, Value};
use crate::report::{Report, quoted};

/// Adds a note for each property that was not read, and for each object that is not in the world.
pub(super) fn tell(objects: &[MitsubaObject], report: &Report) {
    for (at, object) in objects.iter().enumerate() {
        if object.is_used.get() {
            properties(object, report);
        } else if at != object.parent && objects[object.parent].is_used.get() {
            // One note suffices for an unused object and all objects that it contains.
            let (kind, plugin) = (object.kind.name(), quoted(&object.plugin));
            let id = object.id.as_deref().map(|id| format!(" {}", quoted(id)));
            let id = id.unwrap_or_default();
            let message = format!("{kind} {plugin}{id} is not used");
            report.note(&object.place, message);
        }
    }
}

fn properties(object: &MitsubaObject, report: &Report) {
    for property in object.properties.iter().filter(|p| !p.is_read.get()) {
        if let Value::Object(_) = property.value {
            continue;
        }
        let (name, plugin) = (quoted(&property.name), quoted(&object.plugin));
        let kind = object.kind.name();
        let message = match &property.value {
            Value::Reference(id) => {
                format!("reference to {} in {kind} {plugin} is left out", quoted(id))
            }
            _ => format!("{name} of {kind} {plugin} is left out"),
        };
        report.note(&property.place, message);
    }
}
