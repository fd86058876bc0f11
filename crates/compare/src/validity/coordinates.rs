//! Converts rays to the coordinates of a plane. The code follows docs/conventions.md alone, so it
//! is independent of theory.

use super::rays::CheckRay;
use etendue_field::{Frame, Orientation, TwoPlane};
use etendue_theory::rays::Plane;
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

/// Returns the frame in which angles are measured at a point of a surface with this unit normal.
fn local(plane: &Plane, normal: DVec3) -> Frame {
    if plane.orientation.is_local() {
        plane
            .frame
            .turned_to(normal.dot(plane.frame.d).signum() * normal)
    } else {
        plane.frame
    }
}

/// Returns −1 if directions are rotated about the normal, otherwise 1.
fn turned(plane: &Plane) -> f64 {
    if plane.orientation == Orientation::Mirrored {
        -1.0
    } else {
        1.0
    }
}

/// Returns the coordinates of a ray. `on_surface` holds a point and the unit normal of the surface
/// on which the plane lies, if the plane lies on a surface. Returns `None` if the ray travels the
/// wrong way.
pub(super) fn coordinates(
    plane: &Plane,
    ray: &CheckRay,
    on_surface: Option<[DVec3; 2]>,
) -> Option<TwoPlane> {
    let CheckRay { point, direction } = ray.seen_from(&plane.frame);
    let foot = point - point.z / direction.z * direction;
    if plane.orientation == Orientation::Orthogonal {
        let [u, v] = [direction.x, direction.y].map(|d| d / direction.z);
        let (x, y) = (foot.x, foot.y);
        return (direction.z > 0.0).then_some(TwoPlane { x, y, u, v });
    }
    let (at, frame) = match on_surface.filter(|_| plane.orientation.is_local()) {
        Some([point, normal]) => (plane.frame.to_local(point), local(plane, normal)),
        None => (foot, plane.frame),
    };
    let away = if plane.is_arriving() {
        -ray.direction
    } else {
        ray.direction
    };
    let away = frame.vector_to_local(away);
    let turned = turned(plane);
    (away.z > 0.0).then(|| TwoPlane {
        x: at.x,
        y: at.y,
        u: turned * libm::atan2(away.x, away.z) - plane.longitude,
        v: turned * libm::asin(away.y),
    })
}

/// Returns the direction of light that has these slopes or angles at the plane. `normal` is the
/// unit normal at the point where the light leaves a surface.
pub(super) fn direction(plane: &Plane, normal: DVec3, [u, v]: [f64; 2]) -> DVec3 {
    if plane.orientation == Orientation::Orthogonal {
        return plane
            .frame
            .vector_to_world(DVec3::new(u, v, 1.0).normalize());
    }
    let turned = turned(plane);
    let (sin, cos) = libm::sincos(turned * (u + plane.longitude));
    let (up, across) = libm::sincos(turned * v);
    local(plane, normal).vector_to_world(DVec3::new(across * sin, up, across * cos))
}

/// Returns the ray with the coordinates (x, y, u, v) at a plane; `None` where the plane is on a
/// surface and there is no surface at that point.
pub(super) fn seen(plane: &Plane, [x, y, u, v]: [f64; 4]) -> Option<CheckRay> {
    let on_surface = plane.orientation != Orientation::Orthogonal;
    // A direction a full turn away has the same coordinates.
    if on_surface && (u + plane.longitude).abs().max(v.abs()) >= FRAC_PI_2 {
        return None;
    }
    let foot = plane.frame.to_world(DVec3::new(x, y, 0.0));
    let (mut point, mut normal) = (foot, plane.frame.d);
    if let Some(patch) = plane
        .patch
        .as_ref()
        .filter(|_| plane.orientation.is_local())
    {
        let direction = plane.frame.d;
        let down = CheckRay { point, direction }.back(patch);
        point = down.at(down.theory_hit(patch)?);
        normal = patch.normal(point);
    }
    let away = direction(plane, normal, [u, v]);
    let direction = if plane.is_arriving() { -away } else { away };
    Some(CheckRay { point, direction })
}
