//! Checks of the placement of shapes, for any scene format.

use crate::range::{MAX_NUMBER, holds};
use etendue_world::Geometry;
use glam::{DAffine3, DVec3};

/// Maximum relative difference between the axes of a sphere. Transforms are products of rounded
/// numbers, so the axes differ slightly.
const ALIKE: f64 = 1e-4;

/// Returns the reason why a geometry cannot have this placement, if there is one.
pub(crate) fn fault(geometry: &Geometry, to_world: DAffine3) -> Option<&'static str> {
    let [x, y, z] = [0, 1, 2].map(|i| to_world.matrix3.col(i));
    let alike = |a: DVec3, b: DVec3| (a.length() - b.length()).abs() <= ALIKE * a.length();
    let across = |a: DVec3, b: DVec3| a.dot(b).abs() <= ALIKE * a.length() * b.length();
    let is_square = across(x, y) && across(y, z) && across(z, x);
    let fits = match geometry {
        Geometry::Sphere => alike(x, y) && alike(y, z) && is_square,
        Geometry::Cylinder => alike(x, y) && is_square,
        _ => true,
    };
    let lengths = [x, y, z].map(DVec3::length);
    let is_regular = holds(to_world)
        && lengths.iter().all(|length| *length >= 1.0 / MAX_NUMBER)
        && to_world.matrix3.determinant().abs() > 0.0;
    match (is_regular, fits) {
        (false, _) => Some(
            "that is placed out of range, or scaled to size 0; allowed: coordinates up to 1e9, and scales from 1e-9 to 1e9",
        ),
        (true, false) => Some("with shear, or with different scales along its axes"),
        (true, true) => None,
    }
}
