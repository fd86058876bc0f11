//! Converts rays of a leg to lines in space.

use etendue_field::TwoPlane;
use glam::DVec3;

/// The point at which a ray begins, in the frame of the ray.
pub(crate) fn start(ray: &TwoPlane) -> DVec3 {
    DVec3::new(ray.x, ray.y, 0.0)
}

/// The direction of a ray, with component 1 along D.
pub(crate) fn direction(ray: &TwoPlane) -> DVec3 {
    DVec3::new(ray.u, ray.v, 1.0)
}

/// The ray through a point along a direction, or `None` if the direction does not go
/// forward along D. The point and the direction are in the frame of the returned ray.
pub(crate) fn ray_through(point: DVec3, direction: DVec3) -> Option<TwoPlane> {
    let [u, v] = [direction.x / direction.z, direction.y / direction.z];
    (direction.z > 0.0).then_some(TwoPlane {
        x: point.x - point.z * u,
        y: point.y - point.z * v,
        u,
        v,
    })
}
