//! The faults of a scene file, as they are found.

use etendue_scenefile::Fault;
use etendue_scenefile::limits;
use etendue_scenefile::{number, shown};
use std::collections::HashSet;
use std::fmt::Debug;

/// Faults found so far.
#[derive(Default)]
pub(super) struct Faults {
    pub(super) all: Vec<Fault>,
    /// Where the central ray begins and goes is at fault.
    pub(super) astray: bool,
    /// That, or where something stands.
    displaced: bool,
}

impl Faults {
    pub(super) fn add(
        &mut self,
        field: impl Into<String>,
        value: impl Into<String>,
        allowed: impl Into<String>,
    ) {
        let field = field.into();
        self.astray |= field.starts_with("path.") || field.starts_with("light.center");
        self.displaced |= self.astray || is_of_place(&field);
        self.all.push(Fault {
            field: shown(field, limits::VALUE),
            value: shown(value.into(), limits::VALUE),
            allowed: shown(allowed.into(), limits::ALLOWED),
            memory: false,
        });
    }

    /// A fault of where things are on the path: nothing is known of it when their own places, or
    /// those of others, are at fault.
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

    /// Whether something below a field is at fault.
    pub(super) fn has_below(&self, field: &str) -> bool {
        let below = |fault: &Fault| {
            fault
                .field
                .strip_prefix(field)
                .is_some_and(|of| of.starts_with('.'))
        };
        self.all.iter().any(below)
    }

    /// Each fault once: planes share the scene's window and frequencies.
    pub(super) fn once(self) -> Vec<Fault> {
        let mut seen = HashSet::new();
        let is_new: Vec<bool> = self.all.iter().map(|fault| seen.insert(fault)).collect();
        let each = self.all.into_iter().zip(is_new);
        each.filter_map(|(fault, is_new)| is_new.then_some(fault))
            .collect()
    }
}

/// Whether a field says where a surface or blockers are, and so what the central ray meets.
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

/// A vector as it is written.
pub(super) fn vector(values: &[f64]) -> String {
    let values: Vec<String> = values.iter().map(|value| number(*value)).collect();
    format!("({})", values.join(", "))
}

/// A value as it is written, as far as a message shows it.
pub(super) fn show(value: impl Debug) -> String {
    shown(format_args!("{value:?}"), limits::VALUE)
}

/// Names to choose from.
pub(super) fn names<'a>(mut all: impl Iterator<Item = &'a str>) -> String {
    let first = all.by_ref().take(limits::FAULTS);
    let mut listed: Vec<String> = first.map(|name| shown(name, limits::NAME)).collect();
    let more = all.count();
    if more > 0 {
        listed.push(format!("and {more} more"));
    }
    listed.join(", ")
}
