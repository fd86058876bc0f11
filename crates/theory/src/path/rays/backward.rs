//! Follows rays at a plane back to the light through the exact geometry.

use super::AT_LIGHT;
use crate::obstacle::{LegRay, normal};
use crate::path::{PathSurface, PathSystem};
use crate::plane::Plane;
use etendue_field::Specular;
use glam::DVec3;

/// A plane, and the surfaces on the backward path from it.
#[derive(Clone, Debug)]
pub(super) struct Back<'a> {
    plane: Plane,
    surfaces: &'a [PathSurface],
}

impl<'a> Back<'a> {
    pub(super) fn new(system: &'a PathSystem, plane: &Plane) -> Self {
        Self {
            plane: *plane,
            surfaces: system.before_plane(),
        }
    }

    /// The ray (x, y, u, v) at the light's plane that arrives at the coordinates z of the
    /// recording plane, and |∂z/∂ray|. Returns `None` if there is no such ray.
    ///
    /// Reflection and refraction of a ray conserve n² dx dy du dv / (1 + u² + v²)² (docs/theory.md
    /// (29)).
    pub(super) fn ray(&self, z: [f64; 4]) -> Option<([f64; 4], f64)> {
        let (last, etendue) = self.plane.ray(z)?;
        let mut after = last.direction;
        let mut spread = 1.0;
        let mut ray = None;
        for element in self.surfaces.iter().rev() {
            let before = match ray {
                None => self.off_last(element, &last)?,
                Some(ray) => element.follow(&ray)?,
            };
            spread *= element.spread(&before, after)?;
            after = -before.direction;
            ray = Some(before);
        }
        let ray = ray.unwrap_or(LegRay {
            direction: -last.direction,
            ..last
        });
        let travel = -ray.point.z / ray.direction.z;
        // Light starts in the plane z = 0 and travels towards positive z.
        if travel < -AT_LIGHT || ray.direction.z >= 0.0 {
            return None;
        }
        let at = ray.point + travel * ray.direction;
        let [u, v] = [ray.direction.x, ray.direction.y].map(|d| d / ray.direction.z);
        let secant_squared = 1.0 + u * u + v * v;
        let width = etendue * secant_squared * secant_squared;
        Some(([at.x, at.y, u, v], spread / width))
    }

    /// The backward ray that leaves the last surface, for the ray `last` of the last leg.
    /// The line of `last` starts beyond all its possible intersections with the last surface. This
    /// is necessary because a plane at an oblique surface may lie partly behind the surface. If the
    /// plane is on the last surface, the point where the ray leaves this surface is already known.
    fn off_last(&self, element: &PathSurface, last: &LegRay) -> Option<LegRay> {
        let PathSurface { patch, .. } = element;
        let back = -last.direction;
        if self.plane.patch.is_some() && !self.plane.is_arriving() {
            let arriving = LegRay {
                direction: back,
                ..*last
            };
            return element.turned(&arriving, last.point);
        }
        element.follow(&LegRay::back(patch, last.point, last.direction))
    }
}

impl PathSurface {
    /// The factor by which dx dy du dv / (1 + u² + v²)² increases when a ray is followed
    /// backward through the surface. `before` is the ray on the light's side, and `after` is the
    /// direction on the plane's side.
    fn spread(&self, before: &LegRay, after: DVec3) -> Option<f64> {
        let frame = &self.patch.frame;
        Some(match self.event()? {
            Specular::Mirror => 1.0,
            Specular::Refraction { front, back } => {
                let from_front = before.direction.dot(normal(&self.patch, before.point)?) > 0.0;
                let ratio = if from_front {
                    front / back
                } else {
                    back / front
                };
                ratio * ratio
            }
            // A thin lens conserves dx dy du dv if slopes are relative to the lens's frame.
            Specular::ThinLens { .. } => {
                (after.dot(frame.d) / before.direction.dot(frame.d)).powi(4)
            }
        })
    }
}
