//! The radiance of a ray at a plane, as it is.

use super::System;
use super::brdf;
use super::incoming::{Incoming, Rule};
use crate::rays::{Plane, Ray};
use etendue_field::{Fresnel, Lobe, Orientation, TwoPlane};
use glam::DVec3;
use std::f64::consts::PI;

/// Where a ray leaves the surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leaving {
    pub(super) point: DVec3,
    /// On the side the surface faces.
    pub(super) normal: DVec3,
    /// A unit vector.
    pub(super) direction: DVec3,
}

/// Light that arrives at a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shining {
    /// A unit vector to where it comes from.
    from: DVec3,
    /// Radiance times its share of cos θ dω.
    irradiance: f64,
}

impl System {
    /// The ray at (x, y, u, v) of a plane, where it leaves the surface; `None` if it does not.
    pub(super) fn leaving(&self, plane: &Plane, [x, y, u, v]: [f64; 4]) -> Option<Leaving> {
        let frame = &plane.frame;
        let foot = frame.to_world(DVec3::new(x, y, 0.0));
        let away = || {
            let ((sin, cos), (up, across)) = ((u + plane.longitude).sin_cos(), v.sin_cos());
            DVec3::new(across * sin, up, across * cos)
        };
        let (point, normal, direction) = match plane.orientation {
            Orientation::Orthogonal => {
                let along = DVec3::new(u, v, 1.0).normalize();
                self.on_line(foot, frame.vector_to_world(along))?
            }
            Orientation::Tangent => self.on_line(foot, frame.vector_to_world(away()))?,
            Orientation::LocalNormals | Orientation::Mirrored => {
                let (point, normal, _) = self.on_line(foot, frame.d)?;
                let local = frame.turned_to(normal);
                (point, normal, local.vector_to_world(away()))
            }
        };
        let leaves = direction.dot(normal) > 0.0;
        leaves.then_some(Leaving {
            point,
            normal,
            direction,
        })
    }

    /// Where a line goes out through the surface: point, normal and the line's direction.
    fn on_line(&self, at: DVec3, direction: DVec3) -> Option<(DVec3, DVec3, DVec3)> {
        // From far out, so that all of the surface is ahead.
        let far = 4.0 * self.patch.aperture + (at - self.patch.frame.origin).length();
        let ray = Ray {
            point: at + direction * far,
            direction: -direction,
        };
        let (distance, normal) = ray.met(&self.patch)?;
        Some((ray.point - direction * distance, normal, direction))
    }

    /// All that shines on a point that light leaves.
    pub(super) fn shines(&self, leaving: &Leaving, rule: &Rule) -> Vec<Shining> {
        let incoming = self.incoming(leaving.point, rule).into_iter();
        let shining = incoming.map(|Incoming { slopes, weight }| {
            let [u, v] = slopes;
            let secant_squared = TwoPlane {
                u,
                v,
                ..TwoPlane::default()
            }
            .secant_squared();
            let secant = secant_squared.sqrt();
            let from = DVec3::new(-u, -v, -1.0) / secant;
            // dω = du dv cos³.
            let irradiance = weight * leaving.normal.dot(from) / (secant_squared * secant);
            Shining { from, irradiance }
        });
        shining.filter(|s| s.irradiance != 0.0).collect()
    }

    /// The radiance that leaves, of what shines there.
    pub(super) fn radiance(&self, leaving: &Leaving, shines: &[Shining]) -> f64 {
        let Leaving {
            point,
            normal,
            direction,
        } = *leaving;
        let at = self.patch.frame.to_local(point);
        let brdf = self.reflectance.at(at.x, at.y);
        let each = shines.iter();
        // Alike in all directions: nothing is asked of each.
        if (brdf.lobe, brdf.fresnel) == (Lobe::Lambertian, Fresnel::White) {
            let leaves = direction.dot(normal) > 0.0;
            let lit = each.map(|s| {
                if normal.dot(s.from) > 0.0 {
                    s.irradiance
                } else {
                    0.0
                }
            });
            return if leaves {
                brdf.albedo / PI * lit.sum::<f64>()
            } else {
                0.0
            };
        }
        each.map(|s| s.irradiance * brdf::value(&brdf, normal, s.from, direction))
            .sum()
    }
}
