//! The elements of a transform. Each element of a transform is applied after the elements that
//! precede it.

use super::value;
use crate::range::rotation;
use glam::{DAffine3, DMat3, DMat4, DVec3, DVec4};

/// The attributes of an element, after parameters are replaced by their values.
pub(super) type Attributes = Vec<(String, String)>;

/// Maximum deviation of the length of an axis from 1, due to rounded components in a file.
const UNIT: f64 = 1e-3;

/// Maximum deviation of a transform from a rigid transform. Transforms deviate because they are
/// products of rounded numbers.
const RIGID: f64 = 1e-3;

/// The map of one element; `Err` describes a fault.
pub(super) fn step(name: &str, attributes: &Attributes) -> Result<DAffine3, String> {
    match name {
        "translate" | "scale" => {
            allow(attributes, &["x", "y", "z", "value"])?;
            match name {
                "scale" => Ok(DAffine3::from_scale(vector(attributes, 1.0)?)),
                _ => Ok(DAffine3::from_translation(vector(attributes, 0.0)?)),
            }
        }
        "rotate" => {
            allow(attributes, &["x", "y", "z", "value", "angle"])?;
            let axis = vector(attributes, 0.0)?;
            let angle = value::number(required(attributes, "angle")?)?.to_radians();
            let length = axis.length();
            match (length - 1.0).abs() {
                _ if length <= 0.0 => {
                    Err("a rotation axis of length 0; allowed: above 0".to_owned())
                }
                ..=UNIT => Ok(rotation(axis / length, angle)),
                // As in Mitsuba 3, the axis is not normalised.
                _ => Ok(rotation(axis, angle)),
            }
        }
        "lookat" => {
            allow(attributes, &["origin", "target", "up"])?;
            let origin = value::vector(required(attributes, "origin")?)?;
            let target = value::vector(required(attributes, "target")?)?;
            let up = find(attributes, "up").map_or(Ok(DVec3::ZERO), value::vector)?;
            look_at(origin, target, up).ok_or_else(|| {
                "the viewing direction has length 0, or up is parallel to it".to_owned()
            })
        }
        "matrix" => {
            allow(attributes, &["value"])?;
            matrix(&value::numbers(required(attributes, "value")?)?)
        }
        _ => Err(format!("<{name}> is not allowed in a transform")),
    }
}

/// The map from coordinates in which Z points to `target` and Y upwards.
fn look_at(origin: DVec3, target: DVec3, up: DVec3) -> Option<DAffine3> {
    let along = (target - origin).try_normalize()?;
    let up = match up {
        DVec3::ZERO => frame(along).x_axis,
        _ => up,
    };
    let left = up.cross(along).try_normalize()?;
    let linear = DMat3::from_cols(left, along.cross(left), along);
    Some(DAffine3::from_mat3_translation(linear, origin))
}

/// The frame around a unit vector, as in Mitsuba (Duff et al. 2017).
pub(super) fn frame(z: DVec3) -> DMat3 {
    let (s, t) = z.any_orthonormal_pair();
    DMat3::from_cols(s, t, z)
}

/// Checks whether a map is rigid, within the rounding of numbers with few digits.
pub(super) fn is_rigid(map: DAffine3) -> bool {
    let gram = map.matrix3.transpose() * map.matrix3;
    gram.abs_diff_eq(DMat3::IDENTITY, RIGID)
}

/// The map of a matrix. `numbers` has the matrix row by row: all 16 numbers, or the 9
/// numbers of the linear part.
fn matrix(numbers: &[f64]) -> Result<DAffine3, String> {
    let matrix = if let Ok(all) = <[f64; 16]>::try_from(numbers) {
        DMat4::from_cols_array(&all).transpose()
    } else if let Ok(linear) = <[f64; 9]>::try_from(numbers) {
        DMat4::from_mat3(DMat3::from_cols_array(&linear).transpose())
    } else {
        let count = numbers.len();
        return Err(format!("a matrix has {count} numbers; allowed: 9 or 16"));
    };
    if matrix.row(3) != DVec4::W {
        return Err("the last row of a matrix is not 0 0 0 1".to_owned());
    }
    Ok(DAffine3::from_mat4(matrix))
}

fn vector(attributes: &Attributes, default: f64) -> Result<DVec3, String> {
    let each = ["x", "y", "z"].map(|axis| find(attributes, axis));
    if let Some(text) = find(attributes, "value") {
        if each.iter().any(Option::is_some) {
            return Err(
                "value is given together with x, y or z; allowed: only one of the two forms"
                    .to_owned(),
            );
        }
        return value::triple(text).map(DVec3::from);
    }
    let [x, y, z] = each.map(|text| text.map_or(Ok(default), value::number));
    Ok(DVec3::new(x?, y?, z?))
}

pub(super) fn find<'a>(attributes: &'a Attributes, name: &str) -> Option<&'a str> {
    let mut all = attributes.iter();
    all.find(|(known, _)| known == name)
        .map(|(_, value)| value.as_str())
}

pub(super) fn required<'a>(attributes: &'a Attributes, name: &str) -> Result<&'a str, String> {
    find(attributes, name).ok_or_else(|| format!("no attribute {name}"))
}

/// An error if an element has attributes other than the given ones.
pub(super) fn allow(attributes: &Attributes, names: &[&str]) -> Result<(), String> {
    let mut all = attributes.iter();
    match all.find(|(name, _)| !names.contains(&name.as_str())) {
        None => Ok(()),
        Some((name, _)) => Err(format!("attribute {name}; allowed: {}", names.join(", "))),
    }
}
