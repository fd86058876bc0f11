//! Converts crossings of a virtual plane to rays in world coordinates.

use crate::plane_on_leg::PlaneOnLeg;
use etendue_field::{Crossing, Frame, TwoPlane};
use etendue_scene::Scene;
use glam::DVec3;

/// A converter from crossings of a virtual plane to rays in world coordinates. It also computes the
/// power of these rays.
#[derive(Debug)]
pub struct PlaneInWorld {
    plane_on_leg: PlaneOnLeg,
    /// The frame of the plane's leg, in world coordinates.
    leg: Frame,
}

impl PlaneInWorld {
    /// The converter for the virtual plane of a scene with the index `plane`; `None` if
    /// the scene has no such plane.
    #[must_use]
    pub fn new(scene: &Scene, plane: usize) -> Option<Self> {
        let at = scene.planes.get(plane)?;
        let leg = &scene.path.legs[at.leg];
        Some(Self {
            plane_on_leg: PlaneOnLeg::new(scene, plane, at),
            leg: scene.path.frame.compose(&leg.frame),
        })
    }

    /// The point where a ray crosses the virtual plane, in metres, and the unit vector
    /// along which light travels at this point. If the virtual plane lies on a surface, the
    /// returned point lies on this surface. Returns `None` for coordinates that belong to no ray.
    #[must_use]
    pub fn ray(&self, seen: &TwoPlane) -> Option<[DVec3; 2]> {
        let (point, ..) = self.plane_on_leg.point([seen.x, seen.y])?;
        let along = match self.plane_on_leg.view() {
            None => DVec3::new(seen.u, seen.v, 1.0),
            Some(view) => {
                let away = view.direction(point, [seen.u, seen.v])?;
                if view.is_arriving() { -away } else { away }
            }
        };
        let along = self.leg.vector_to_world(along).normalize();
        Some([self.leg.to_world(point), along])
    }

    /// The flux of a photon times the number of photons emitted, W. This flux is the
    /// photon's weight times cos θ dω / du dv, because the reciprocal of cos θ dω / du dv
    /// converts flux to radiance space (docs/conventions.md).
    #[must_use]
    pub fn flux(&self, crossing: &Crossing) -> f64 {
        crossing.weight * self.plane_on_leg.flux_per_radiance(&crossing.ray)
    }
}
