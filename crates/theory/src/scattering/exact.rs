//! The exact radiance of a ray at a plane.

use super::ScatteringSystem;
use super::brdf;
use super::incoming::{IncomingLight, LightPart, secant};
use crate::mask::Masks;
use crate::obstacle::LegRay;
use crate::rays::Plane;
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

impl ScatteringSystem {
    /// Returns the point of the surface from which the ray (x, y, u, v) of a plane comes, or
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

    /// Returns the point where a line leaves through the front of the surface, the normal at this
    /// point, and the direction of the line.
    fn on_line(&self, at: DVec3, direction: DVec3) -> Option<(DVec3, DVec3, DVec3)> {
        let ray = LegRay::back(&self.patch, at, direction);
        let (distance, normal) = ray.met(&self.patch)?;
        Some((ray.point - direction * distance, normal, direction))
    }

    /// Returns the radiance that leaves the surface due to a part of the light, per unit of the
    /// part's measure.
    pub(super) fn radiance(&self, masks: &Masks<'_>, leaving: &Leaving, part: LightPart) -> f64 {
        let Leaving {
            point,
            normal,
            direction,
        } = *leaving;
        let IncomingLight { slopes, weight } = masks.incoming(&self.light, point, part);
        let [u, v] = slopes;
        let secant = secant(slopes);
        let wi = DVec3::new(-u, -v, -1.0) / secant;
        let cosine = normal.dot(wi);
        if weight <= 0.0 || cosine <= 0.0 {
            return 0.0;
        }
        let at = self.patch.frame.to_local(point);
        let brdf = self.reflectance.at(at.x, at.y);
        // dω = du dv cos³.
        weight * cosine / secant.powi(3) * brdf::sum(&brdf, normal, wi, direction)
    }
}
