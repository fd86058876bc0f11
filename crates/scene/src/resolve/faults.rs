use crate::fault::Fault;
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
            field: field.into(),
            value: value.into(),
            allowed: allowed.into(),
            memory: false,
        });
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

pub(super) fn show(value: impl Debug) -> String {
    format!("{value:?}")
}
