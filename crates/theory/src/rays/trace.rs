//! Tracing of a single ray through a specular system.

use super::{SpecularSurface, SpecularSystem};
use crate::obstacle::{LegRay, PreparedObstacles};
use etendue_field::{Frame, Patch, Specular};
use glam::DVec3;

impl LegRay {
    /// Returns the ray with position (x, y) and slopes (u, v) at the light's plane.
    pub(crate) fn new([x, y, u, v]: [f64; 4]) -> Self {
        Self {
            point: DVec3::new(x, y, 0.0),
            direction: DVec3::new(u, v, 1.0).normalize(),
        }
    }

    /// Returns the line through a point along a unit vector. The line starts beyond all its
    /// intersections with a patch.
    pub(crate) fn back(patch: &Patch, through: DVec3, along: DVec3) -> Self {
        let far = 4.0 * patch.aperture + (through - patch.frame.origin).length();
        Self {
            point: through + along * far,
            direction: -along,
        }
    }

    /// Returns the distance along the ray to a patch, and the patch's unit normal at the hit point
    /// on the side of the patch's D. Returns `None` if the ray misses the patch or the patch is
    /// behind the ray's start.
    ///
    /// Solves for the distance by Newton's method, starting at the tangent plane at the patch's
    /// vertex. Along a ray the quadric is a polynomial of degree two, so it has at most one root
    /// on either side of its extremum. The method converges to the root nearer to the tangent
    /// plane.
    pub(crate) fn met(&self, patch: &Patch) -> Option<(f64, DVec3)> {
        self.met_facing(patch, None)
    }

    /// Returns the intersection at which the ray meets a patch from the given side, even if
    /// another intersection is nearer. `side` is 1 for the side of the patch's D and −1 for the
    /// opposite side.
    ///
    /// A ray meets a quadric at most once from either side, so the intersection is unique.
    pub(crate) fn met_from(&self, patch: &Patch, side: f64) -> Option<(f64, DVec3)> {
        self.met_facing(patch, Some(side))
    }

    fn met_facing(&self, patch: &Patch, side: Option<f64>) -> Option<(f64, DVec3)> {
        let point = patch.frame.to_local(self.point);
        let direction = patch.frame.vector_to_local(self.direction);
        let mut t = if direction.z.abs() > 1e-3 {
            -point.z / direction.z
        } else {
            -point.dot(direction)
        };
        // At distance s along the ray from a point `near` the patch, the patch's implicit function
        // is a s² + 2 b s + c.
        let near = point + direction * t;
        let a = (DVec3::from(patch.curvature) * direction).dot(direction);
        let b = patch.gradient(near).dot(direction);
        let c = patch.value(near);
        // The two roots are on opposite sides of the extremum. The mirror image of one root about
        // the extremum is a good first estimate of the other root.
        let leaves = side.is_some_and(|side| side * b > 0.0);
        let mut s = if leaves { -2.0 * b / a } else { 0.0 };
        for _ in 0..MOST_STEPS {
            let step = ((a * s + 2.0 * b) * s + c) / (2.0 * (a * s + b));
            s -= step;
            // Each Newton step squares the relative error, so the next step would be below
            // rounding error.
            if step.abs() <= 1e-8 * ((t + s).abs() + point.length()) {
                t += s;
                let here = point + direction * t;
                let normal = patch.gradient(here).try_normalize()?;
                let found = t > 0.0 && patch.contains(here);
                return found.then(|| (t, patch.frame.vector_to_world(normal)));
            }
        }
        None
    }
}

/// Maximum number of Newton steps before a ray is treated as a miss. For rays that narrowly miss a
/// surface, the method does not converge.
const MOST_STEPS: u32 = 40;

impl SpecularSurface {
    /// Returns the ray that continues an arriving ray after the surface, or `None` if the ray is
    /// lost.
    pub(super) fn follow(&self, ray: &LegRay) -> Option<LegRay> {
        let (distance, normal) = ray.met(&self.patch)?;
        let point = ray.point + ray.direction * distance;
        self.turned(ray.direction, point, normal)
    }

    /// Returns the ray that leaves `point` after a ray along `direction` has hit the surface at
    /// this point; `normal` is on the side of the patch's D.
    pub(super) fn turned(&self, direction: DVec3, point: DVec3, normal: DVec3) -> Option<LegRay> {
        let direction = bent(self.event, &self.patch.frame, [direction, point, normal])?;
        Some(LegRay { point, direction })
    }
}

/// Returns the direction of light after an event on a patch with the given frame, if light along
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

impl SpecularSystem {
    /// Returns the last leg of a ray from the light, and the fraction of the ray's light that
    /// passes the obstacles on the legs before the last.
    pub(super) fn follow_past(
        &self,
        obstacles: &PreparedObstacles<'_>,
        emission: [f64; 4],
    ) -> Option<(LegRay, f64)> {
        let mut ray = LegRay::new(emission);
        let mut passes = 1.0;
        for (leg, element) in self.elements.iter().enumerate() {
            let (distance, normal) = ray.met(&element.patch)?;
            passes *= obstacles.passes(leg, &ray, distance);
            let point = ray.point + ray.direction * distance;
            ray = element.turned(ray.direction, point, normal)?;
        }
        Some((ray, passes))
    }

    /// Returns the last leg of the ray that starts with (x, y, u, v) at the light's plane, without
    /// masks or obstacles.
    pub(super) fn follow(&self, emission: [f64; 4]) -> Option<LegRay> {
        let start = LegRay::new(emission);
        self.elements
            .iter()
            .try_fold(start, |ray, element| element.follow(&ray))
    }
}
