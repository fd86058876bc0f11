//! Collects the faults of a scene file.

use etendue_scenefile::limits;
use etendue_scenefile::{Fault, fault};
use etendue_scenefile::{number, shown};
use std::collections::HashSet;
use std::fmt::Debug;

/// The faults found so far.
#[derive(Default)]
pub(super) struct Faults {
    pub(super) all: Vec<Fault>,
    /// Whether the origin or the direction of the central ray has a fault.
    pub(super) astray: bool,
    /// Whether the origin or direction of the central ray, or the position of an object, has a
    /// fault.
    displaced: bool,
}

impl Faults {
    pub(super) fn add(
        &mut self,
        field: impl Into<String>,
        value: impl Into<String>,
        allowed: impl Into<String>,
    ) {
        self.add_fault(fault(field, value.into(), allowed));
    }

    pub(super) fn add_fault(&mut self, fault: Fault) {
        let field = fault.field;
        self.astray |= field.starts_with("path.") || field.starts_with("light.center");
        self.displaced |= self.astray || is_of_place(&field);
        self.all.push(Fault {
            field: shown(field, limits::VALUE),
            value: shown(fault.value, limits::VALUE),
            allowed: shown(fault.allowed, limits::ALLOWED),
            memory: fault.memory,
        });
    }

    /// Adds a fault in the position of an object along the path. The fault is omitted if the
    /// position of any object is already faulty, because the path is then unknown.
    pub(super) fn add_on_path(
        &mut self,
        field: impl Into<String>,
        value: impl Into<String>,
        allowed: impl Into<String>,
    ) {
        if !self.displaced {
            self.add(field, value, allowed);
        }
    }

    /// Checks whether a field, or a field nested in it, has a fault.
    pub(super) fn has_below(&self, field: &str) -> bool {
        let below = |fault: &Fault| {
            fault
                .field
                .strip_prefix(field)
                .is_some_and(|of| of.starts_with('.'))
        };
        self.all.iter().any(below)
    }

    /// The faults without duplicates, which arise because planes share the window and
    /// frequencies of the scene.
    pub(super) fn once(self) -> Vec<Fault> {
        let mut seen = HashSet::new();
        let is_new: Vec<bool> = self.all.iter().map(|fault| seen.insert(fault)).collect();
        let each = self.all.into_iter().zip(is_new);
        each.filter_map(|(fault, is_new)| is_new.then_some(fault))
            .collect()
    }
}

/// Checks whether a field sets the position of a surface or of blockers. These positions determine
/// which objects the central ray meets.
fn is_of_place(field: &str) -> bool {
    let of_things = |list: &str| {
        field
            .strip_prefix(list)?
            .split_once("].")
            .map(|(_, field)| field)
    };
    let starts = |field: Option<&str>, names: &[&str]| {
        field.is_some_and(|field| names.iter().any(|name| field.starts_with(name)))
    };
    let of_surface = [
        "center", "size", "facing", "form", "along", "aperture", "mesh", "scale",
    ];
    starts(of_things("surfaces["), &of_surface)
        || starts(of_things("surfaces["), &["event.front", "event.back"])
        || field.ends_with("].event")
        || starts(of_things("blockers["), &["center", "mesh", "scale"])
}

/// A vector as it is written in a scene file.
pub(super) fn vector(values: &[f64]) -> String {
    let values: Vec<String> = values.iter().map(|value| number(*value)).collect();
    format!("({})", values.join(", "))
}

/// A value as it is written in a scene file, truncated for a message.
pub(super) fn show(value: impl Debug) -> String {
    shown(format_args!("{value:?}"), limits::VALUE)
}

/// The list of allowed names for a message.
pub(super) fn names<'a>(mut all: impl Iterator<Item = &'a str>) -> String {
    let first = all.by_ref().take(limits::FAULTS);
    let mut listed: Vec<String> = first.map(|name| shown(name, limits::NAME)).collect();
    let more = all.count();
    if more > 0 {
        listed.push(format!("and {more} more"));
    }
    listed.join(", ")
}
