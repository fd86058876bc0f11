//! The exact radiance of a ray at a plane.

use super::brdf;
use super::incoming::{IncomingLight, secant};
use crate::light::LightPart;
use crate::obstacle::LegRay;
use crate::path::{AtMask, PathSystem, PreparedPath};
use crate::plane::Plane;
use etendue_field::Orientation;
use glam::DVec3;

/// The point where a ray leaves the surface, with its normal and direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leaving {
    pub(super) point: DVec3,
    /// The normal on the side that the surface faces.
    pub(super) normal: DVec3,
    /// The direction in which the ray leaves, a unit vector.
    pub(super) direction: DVec3,
}

impl PathSystem {
    /// The point of the surface from which the ray (x, y, u, v) of a plane comes, or
    /// `None` if the ray does not come from the surface.
    pub(super) fn leaving(&self, plane: &Plane, [x, y, u, v]: [f64; 4]) -> Option<Leaving> {
        let frame = &plane.frame;
        let foot = frame.to_world(DVec3::new(x, y, 0.0));
        let away = || plane.away([u, v]);
        let (point, normal, direction) = match plane.orientation {
            Orientation::Orthogonal => {
                let along = DVec3::new(u, v, 1.0).normalize();
                self.on_line(foot, frame.vector_to_world(along))?
            }
            Orientation::Tangent => self.on_line(foot, frame.vector_to_world(away()?))?,
            Orientation::LocalNormals | Orientation::Mirrored => {
                let (point, normal, _) = self.on_line(foot, frame.d)?;
                let local = frame.turned_to(normal);
                (point, normal, local.vector_to_world(away()?))
            }
        };
        let leaves = direction.dot(normal) > 0.0;
        leaves.then_some(Leaving {
            point,
            normal,
            direction,
        })
    }

    /// The point where a line leaves through the front of the surface, the normal at this
    /// point, and the direction of the line.
    fn on_line(&self, at: DVec3, direction: DVec3) -> Option<(DVec3, DVec3, DVec3)> {
        let (patch, _) = self.scatterer();
        let ray = LegRay::back(patch, at, direction);
        let (distance, normal) = ray.met(patch)?;
        Some((ray.point - direction * distance, normal, direction))
    }
}

impl PreparedPath<'_> {
    /// The radiance that leaves the surface due to a part of the light, per unit of the
    /// part's measure.
    pub(super) fn radiance(&self, leaving: &Leaving, part: LightPart, at_mask: AtMask<'_>) -> f64 {
        let Leaving {
            point,
            normal,
            direction,
        } = *leaving;
        let passes = |ray: &LegRay, length| self.reaches(0, ray, length, at_mask);
        let IncomingLight { slopes, weight } = self.incoming(point, part, passes);
        let [u, v] = slopes;
        let secant = secant(slopes);
        let wi = DVec3::new(-u, -v, -1.0) / secant;
        let cosine = normal.dot(wi);
        if weight <= 0.0 || cosine <= 0.0 {
            return 0.0;
        }
        let (patch, reflectance) = self.system.scatterer();
        let at = patch.frame.to_local(point);
        let brdf = reflectance.at(at.x, at.y);
        // dω = du dv cos³.
        weight * cosine / secant.powi(3) * brdf::sum(&brdf, normal, wi, direction)
    }
}
