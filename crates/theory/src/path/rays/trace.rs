//! Tracing of a single ray through a specular system.

use crate::obstacle::LegRay;
use crate::path::{AtMask, PathSystem, PreparedPath};
use etendue_field::{Frame, Specular};
use glam::DVec3;

/// The direction of light after an event on a patch with the given frame, if light along
/// `direction` hits `point`; `normal` is on the side of the patch's D.
pub(crate) fn bent(
    event: Specular,
    frame: &Frame,
    [direction, point, normal]: [DVec3; 3],
) -> Option<DVec3> {
    match event {
        Specular::Mirror => Some(direction - normal * (2.0 * direction.dot(normal))),
        Specular::Refraction { front, back } => {
            let cos = -direction.dot(normal);
            // The index ratio and the normal are relative to the side of the incident light.
            let (normal, cos, ratio) = if cos > 0.0 {
                (normal, cos, front / back)
            } else {
                (-normal, -cos, back / front)
            };
            let tangential = (direction + normal * cos) * ratio;
            let kept = 1.0 - tangential.length_squared();
            (kept > 0.0).then(|| tangential - normal * kept.sqrt())
        }
        Specular::ThinLens { focal_length } => {
            let (at, towards) = (frame.to_local(point), frame.vector_to_local(direction));
            let slopes = towards / towards.z.abs();
            let bent = DVec3::new(
                slopes.x - at.x / focal_length,
                slopes.y - at.y / focal_length,
                slopes.z,
            );
            Some(frame.vector_to_world(bent.normalize()))
        }
    }
}

impl PreparedPath<'_> {
    /// The last leg of a ray from the light, and the fraction of the ray's light that
    /// passes on the legs before the last. A ray that is stopped is followed all the same.
    pub(super) fn follow(&self, emission: [f64; 4], at_mask: AtMask<'_>) -> Option<(LegRay, f64)> {
        let mut ray = LegRay::new(emission);
        let mut passes = 1.0;
        for (leg, surface) in self.system.before_plane().iter().enumerate() {
            let distance = surface.first(&ray, ray.start())?;
            passes *= self.passes(leg, &ray, distance, at_mask);
            ray = surface.turned(&ray, ray.at(distance))?;
        }
        Some((ray, passes))
    }
}

impl PathSystem {
    /// The last leg of the ray that starts with (x, y, u, v) at the light's plane, without
    /// masks or obstacles.
    pub(super) fn follow(&self, emission: [f64; 4]) -> Option<LegRay> {
        let mut surfaces = self.before_plane().iter();
        surfaces.try_fold(LegRay::new(emission), |ray, surface| surface.follow(&ray))
    }
}
