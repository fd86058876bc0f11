//! Renames properties of files older than version 2, as Mitsuba 3 does.

use super::object::{MitsubaObject, ObjectProperty, Value};
use glam::{DAffine3, DVec3};

/// Converts names such as `toWorld` to `to_world`, and `intIOR` to `int_ior`.
pub(super) fn underscored(name: &str) -> String {
    let mut made = String::with_capacity(name.len() + 4);
    let mut before: Option<char> = None;
    let mut is_in_capitals = false;
    for c in name.chars() {
        let begins = c.is_ascii_uppercase() && before.is_some_and(|b| b.is_ascii_lowercase());
        if begins {
            made.push('_');
        }
        is_in_capitals = c.is_ascii_uppercase() && (begins || is_in_capitals);
        made.push(if is_in_capitals {
            c.to_ascii_lowercase()
        } else {
            c
        });
        before = Some(c);
    }
    made
}

/// Replaces properties that have another name or form in Mitsuba 3: the reflectance of diffuse
/// surfaces, and the scales and offsets of texture coordinates.
pub(super) fn upgrade(object: &mut MitsubaObject<'_>) {
    if object.plugin == "diffuse" {
        for property in &mut object.properties {
            if property.name == "diffuse_reflectance" {
                property.name = "reflectance".to_owned();
            }
        }
    }
    let [u_offset, v_offset, u_scale, v_scale] =
        ["uoffset", "voffset", "uscale", "vscale"].map(|name| take(object, name));
    let all = [&u_offset, &v_offset, &u_scale, &v_scale];
    let Some(place) = all
        .into_iter()
        .flatten()
        .map(|(_, place)| place.clone())
        .next()
    else {
        return;
    };
    let value = |found: Option<(f64, _)>, default| found.map_or(default, |(value, _)| value);
    let scale = DVec3::new(value(u_scale, 1.0), value(v_scale, 1.0), 1.0);
    let offset = DVec3::new(value(u_offset, 0.0), value(v_offset, 0.0), 0.0);
    let to_uv = DAffine3::from_scale(scale) * DAffine3::from_translation(offset);
    object.properties.push(ObjectProperty {
        name: "to_uv".to_owned(),
        value: Value::Transform(Box::new(to_uv)),
        place,
        is_read: false.into(),
    });
}

fn take(object: &mut MitsubaObject<'_>, name: &str) -> Option<(f64, crate::report::SourcePlace)> {
    let at = object.properties.iter().position(|p| p.name == name)?;
    let value = match object.properties[at].value {
        Value::Number(value) => value,
        _ => return None,
    };
    let property = object.properties.remove(at);
    Some((value, property.place))
}
