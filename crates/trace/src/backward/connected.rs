//! Connects points to light without extent, which no ray hits by chance: point lights, projectors
//! and beams.
//!
//! Exactly one path leads from a given point to a light without extent, so only this path is
//! traced.

use etendue_field::{Light, TwoPlane, VirtualPlane};
use etendue_scene::{Event, Object, Scene};
use glam::DVec3;

/// Checks whether rays traced back from a virtual plane find the light. Light without extent is
/// found only if no mirror, interface or lens deflects it before it reaches the virtual plane or
/// the first surface that scatters it. Rays traced back from the position of a point light do not
/// find this light. Rays traced back never find a light that is a list of rays from a file.
#[must_use]
pub fn finds(scene: &Scene, plane: &VirtualPlane) -> bool {
    let first = scene.path.legs.get(1).and_then(|leg| leg.leaves.as_ref());
    let turns = first.is_some_and(|hit| match hit.object {
        Object::Surface(_) => false,
        Object::Mesh(i) => scene.meshes[i].smooth.is_some(),
        Object::Patch(i) => matches!(scene.patches[i].event, Event::Specular(_)),
    });
    let light = &scene.light;
    // A randomly drawn ray never coincides with a ray of a file.
    if light.listed().is_some() {
        return false;
    }
    let is_at_point = plane.leg == 0 && plane.distance <= 0.0 && !light.is_distant();
    light.has_extent() || !is_at_point && (plane.leg == 0 || !turns)
}

/// The ray from a light without extent to `point`. `point` is in the frame at the light,
/// and the ray is given in the plane of the light. Also returns a ratio: the irradiance that the
/// light causes at `point` on an area perpendicular to the ray, divided by the value of the ray per
/// du dv or dx dy.
pub(super) fn connection(light: &Light, point: DVec3) -> Option<(TwoPlane, f64)> {
    let [x, y] = [point.x, point.y];
    if point.z < 0.0 || point.z == 0.0 && !light.is_distant() {
        return None;
    }
    if light.is_distant() {
        let (u, v) = (0.0, 0.0);
        return Some((TwoPlane { x, y, u, v }, 1.0));
    }
    let [u, v] = [x / point.z, y / point.z];
    let (x, y) = (0.0, 0.0);
    let ray = TwoPlane { x, y, u, v };
    // dω = du dv / (1 + u² + v²)^(3/2), and r² = z² (1 + u² + v²). The value of the ray already
    // includes one factor √(1 + u² + v²).
    let secant_squared = ray.secant_squared();
    let spread = point.z * point.z * secant_squared * secant_squared.sqrt();
    Some((ray, 1.0 / spread))
}
