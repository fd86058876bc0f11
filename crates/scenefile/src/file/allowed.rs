//! Defines attributes of the types of scene files. The attributes of a field are a description, an
//! example, and the allowed range of its numbers. The schema, the hints in messages and the checks
//! of all numbers are derived from these attributes.

use crate::display::number;
use crate::limits::MAX_NUMBER;
use schemars::Schema;
use serde_json::Value;

/// Adds the description and an example of a field.
pub(super) fn told(what: &'static str, example: &'static str) -> impl FnMut(&mut Schema) {
    move |schema| {
        schema.insert("title".into(), what.into());
        schema.insert("x-ron".into(), example.into());
    }
}

/// Sets the smallest and the largest allowed number.
pub(super) fn within(least: f64, most: f64) -> impl FnMut(&mut Schema) {
    move |schema| numbers(schema, |node| bound(node, least, most))
}

/// Describes the allowed range of a field in words. This is used if the range depends on other
/// fields, so that it is checked only when the scene is resolved.
pub(super) fn depends(words: &'static str) -> impl FnMut(&mut Schema) {
    move |schema| numbers(schema, |node| node["x-range"] = words.into())
}

/// Adds the reason why numbers outside the range are not allowed.
pub(super) fn since(reason: &'static str) -> impl FnMut(&mut Schema) {
    move |schema| {
        numbers(schema, |node| {
            let range = node["x-range"].as_str().unwrap_or_default();
            node["x-range"] = format!("{range}: {reason}").into();
        });
    }
}

/// Allows all numbers that a scene may contain.
pub(super) fn any(schema: &mut Schema) {
    within(-MAX_NUMBER, MAX_NUMBER)(schema);
}

/// Allows positive numbers, as for sizes, widths, frequencies and strengths; by default,
/// every number has this range.
pub(crate) fn positive(node: &mut Value) {
    bound(node, 1.0 / MAX_NUMBER, MAX_NUMBER);
}

/// Checks whether the type of a node is a number; the type may be optional.
pub(crate) fn is_number(node: &Value) -> bool {
    let is = |name: &Value| name == "number" || name == "integer";
    let names = node.get("type");
    names.is_some_and(|name| is(name) || name.as_array().is_some_and(|names| names.iter().any(is)))
}

/// Describes a direction of any length.
pub(super) fn direction(example: &'static str) -> impl FnMut(&mut Schema) {
    move |schema| {
        told("a direction", example)(schema);
        any(schema);
    }
}

/// Attributes that several fields share: a description, an example and optionally a range.
macro_rules! shared {
    ($($name:ident: $what:literal, $example:literal $(, $numbers:expr)?;)*) => {$(
        pub(super) fn $name(schema: &mut Schema) {
            told($what, $example)(schema);
            $($numbers(schema);)?
        }
    )*};
}

shared! {
    name: "a name in quotes, 1 to 64 characters", "\"floor\"";
    name_of_blockers: "a name in quotes, 1 to 64 characters", "\"bars\"";
    seed: "a whole number", "1", depends("0 to 2^64 − 1");
    place: "a place in the world, in metres", "(0, 0, 1)", any;
    sides: "side lengths along X and Y, in metres", "(0.2, 0.1)";
    length: "a length in metres", "0.2";
    factor: "a factor", "2";
    radiance: "a radiance, in W m⁻² sr⁻¹, or three for red, green and blue", "1";
    intensity: "an intensity, in W sr⁻¹, or three for red, green and blue", "1";
    cycles: "cycles per metre", "5";
    modulation: "a contrast", "0.9", within(0.0, 1.0);
    phase: "an angle in radians", "0.3", any;
    albedo: "a share of the light, or three for red, green and blue", "0.5", within(0.0, 1.0);
    factors_by_angle: "factors from 0 to 1, for angles from the normal to 90 degrees", "[1, 0.7, 0]", within(0.0, 1.0);
    profile_of_place: "a profile with its half-width in metres", "Hann(0.5)";
    profile_of_slope: "a profile with its half-width as a slope", "Hann(0.5)";
}

fn bound(node: &mut Value, least: f64, most: f64) {
    node["x-range"] = format!("{} to {}", number(least), number(most)).into();
    node["minimum"] = least.into();
    node["maximum"] = most.into();
}

/// Adds an attribute to a number, or to each number in a list or in a list of lists. A colour is a
/// number or a list.
fn numbers(schema: &mut Schema, tell: impl Fn(&mut Value)) {
    let mut each = String::new();
    while let Some(node) = schema.pointer_mut(&each) {
        let is_list = node.get("items").is_some();
        if !is_list || is_number(node) {
            tell(node);
        }
        if !is_list {
            break;
        }
        each += "/items";
    }
}
