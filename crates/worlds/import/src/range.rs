//! The range of numbers that a scene may hold, checks of the placement of shapes, and rotations,
//! for any format.

use etendue_world::{Geometry, Texture};
use glam::{DAffine3, DMat3, DVec3};

/// The largest number in a scene, as in Étendue's own scenes. With this limit, sums of products of
/// several numbers stay far within the range of f64.
pub(crate) const MAX_NUMBER: f64 = 1e9;

/// The largest albedo of a surface. The limit slightly exceeds 1 because the weights of colour
/// channels add up to 1 only up to rounding errors.
pub(crate) const MAX_SHARE: f64 = 1.0 + 1e-9;

/// Maximum relative difference between the axes of a sphere. Transforms are products of rounded
/// numbers, so the axes differ slightly.
const ALIKE: f64 = 1e-4;

/// Maximum number of shapes of a world, and of lights of a glTF file; the limit is needed because a
/// scene may repeat both.
pub(crate) const MAX_SHAPES: usize = 1 << 20;

/// Maximum number of materials of a world, including nested ones; the limit is needed because
/// references may duplicate nested materials.
pub(crate) const MAX_MATERIALS: usize = 1 << 20;

/// Maximum number of pixels of a camera across or down.
pub(crate) const MAX_PIXELS: i64 = 1 << 16;

/// Checks that a number is in range; `Err` describes the fault.
pub(crate) fn in_range(value: f64) -> Result<f64, String> {
    match value.abs() <= MAX_NUMBER {
        true => Ok(value),
        false => Err(format!(
            "{value:e} is out of range; allowed: {:e} to {MAX_NUMBER:e}",
            -MAX_NUMBER
        )),
    }
}

/// Returns a texture whose values are at most 1; `Err` describes the fault.
pub(crate) fn share(name: &str, texture: Texture) -> Result<Texture, String> {
    let largest = texture.largest();
    match largest <= MAX_SHARE {
        true => Ok(texture),
        false => Err(format!("{name} goes up to {largest}; allowed: 0 to 1")),
    }
}

/// Checks whether all numbers of a map are in range.
pub(crate) fn holds(map: DAffine3) -> bool {
    map.to_cols_array().iter().all(|v| v.abs() <= MAX_NUMBER)
}

/// The reason why a geometry cannot have the given placement, or `None` if the placement is
/// allowed. `shines` states whether the shape emits. A sphere that emits must stay a sphere,
/// because points of a light are drawn uniformly by area.
pub(crate) fn fault(geometry: &Geometry, to_world: DAffine3, shines: bool) -> Option<&'static str> {
    let fits = match geometry {
        Geometry::Sphere => !shines || is_similarity(to_world.matrix3),
        Geometry::Cylinder => {
            let [x, y, _] = axes(to_world.matrix3);
            alike(x, y) && is_orthogonal(to_world.matrix3)
        }
        _ => true,
    };
    let lengths = axes(to_world.matrix3).map(DVec3::length);
    let is_regular = holds(to_world)
        && lengths.iter().all(|length| *length >= 1.0 / MAX_NUMBER)
        && to_world.matrix3.determinant().abs() > 0.0;
    match (is_regular, fits) {
        (false, _) => Some(
            "is placed out of range, or scaled to size 0; allowed: coordinates up to 1e9, and scales from 1e-9 to 1e9",
        ),
        (true, false) if matches!(geometry, Geometry::Sphere) => {
            Some("emits, but has shear or different scales along its axes")
        }
        (true, false) => Some("has shear, or different scales along its axes"),
        (true, true) => None,
    }
}

/// Checks whether a map keeps angles, and therefore maps spheres to spheres.
pub(crate) fn is_similarity(map: DMat3) -> bool {
    let [x, y, z] = axes(map);
    alike(x, y) && alike(y, z) && is_orthogonal(map)
}

/// A similarity that replaces a regular map. Both maps take X to the same vector, and Y to
/// the same side of this vector in the same plane. The similarity mirrors if the map mirrors.
pub(crate) fn similar(map: DMat3) -> DMat3 {
    let [x, y, z] = axes(map);
    let along = x.normalize();
    let aside = y.reject_from_normalized(along).normalize();
    let up = along.cross(aside);
    x.length() * DMat3::from_cols(along, aside, up * up.dot(z).signum())
}

/// The rotation about a unit axis (Rodrigues). Another length of the axis also distorts.
pub(crate) fn rotation(axis: DVec3, angle: f64) -> DAffine3 {
    let (sin, cos) = libm::sincos(angle);
    let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z]
        .map(|unit| cos * unit + (1.0 - cos) * axis.dot(unit) * axis + sin * axis.cross(unit));
    DAffine3::from_mat3(DMat3::from_cols(x, y, z))
}

fn axes(map: DMat3) -> [DVec3; 3] {
    [0, 1, 2].map(|i| map.col(i))
}

fn alike(a: DVec3, b: DVec3) -> bool {
    (a.length() - b.length()).abs() <= ALIKE * a.length()
}

fn is_orthogonal(map: DMat3) -> bool {
    let [x, y, z] = axes(map);
    let across = |a: DVec3, b: DVec3| a.dot(b).abs() <= ALIKE * a.length() * b.length();
    across(x, y) && across(y, z) && across(z, x)
}
