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

    /// Requires a finite number in a closed range.
    pub(super) fn within(
        &mut self,
        field: impl Into<String>,
        value: f64,
        range: RangeInclusive<f64>,
    ) {
        if !range.contains(&value) {
            self.add(
                field,
                show(value),
                format!("{} to {}", range.start(), range.end()),
            );
        }
    }

    /// Requires a length or width: finite and above zero.
    pub(super) fn positive(&mut self, field: impl Into<String>, value: f64) {
        if !(value > 0.0 && value.is_finite()) {
            self.add(field, show(value), "a finite number above 0");
        }
    }

    pub(super) fn finite(&mut self, field: &str, values: &[f64]) {
        for (i, value) in values.iter().enumerate().filter(|(_, v)| !v.is_finite()) {
            self.add(format!("{field}[{i}]"), show(*value), "a finite number");
        }
    }
}

pub(super) fn show(value: impl Debug) -> String {
    format!("{value:?}")
}
