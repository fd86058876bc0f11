//! The faults of a scene file, as they are found.

use crate::fault::Fault;
use crate::limits;
use crate::shown::shown;
use std::collections::HashSet;
use std::fmt::Debug;
use std::ops::RangeInclusive;

/// Faults found so far.
#[derive(Default)]
pub(super) struct Faults(pub(super) Vec<Fault>);

impl Faults {
    pub(super) fn add(
        &mut self,
        field: impl Into<String>,
        value: impl Into<String>,
        allowed: impl Into<String>,
    ) {
        self.0.push(Fault {
            field: shown(field.into(), limits::VALUE),
            value: shown(value.into(), limits::VALUE),
            allowed: shown(allowed.into(), limits::ALLOWED),
            memory: false,
        });
    }

    /// Each fault once: planes share the scene's window and frequencies.
    pub(super) fn once(self) -> Vec<Fault> {
        let mut seen = HashSet::new();
        let is_new: Vec<bool> = self.0.iter().map(|fault| seen.insert(fault)).collect();
        let each = self.0.into_iter().zip(is_new);
        each.filter_map(|(fault, is_new)| is_new.then_some(fault))
            .collect()
    }

    /// Requires a number in a closed range.
    pub(super) fn within(
        &mut self,
        field: impl Into<String>,
        value: f64,
        range: RangeInclusive<f64>,
    ) {
        if !range.contains(&value) {
            let (low, high) = range.into_inner();
            self.add(field, show(value), format!("{low:?} to {high:?}"));
        }
    }

    /// Requires a size, a width or a frequency.
    pub(super) fn positive(&mut self, field: impl Into<String>, value: f64) {
        self.within(field, value, 1.0 / LARGEST..=LARGEST);
    }

    /// Requires coordinates.
    pub(super) fn coordinates(&mut self, field: &str, values: &[f64]) {
        for (i, value) in values.iter().enumerate() {
            self.within(format!("{field}[{i}]"), *value, -LARGEST..=LARGEST);
        }
    }
}

/// The largest number a scene may hold, and the inverse of the smallest size: their products to the sixth
/// power, which a power spectrum has, stay far inside what f64 holds.
const LARGEST: f64 = 1e9;

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
