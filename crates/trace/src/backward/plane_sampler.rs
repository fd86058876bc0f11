//! Defines how the backward tracer draws rays at one virtual plane.

use super::end::End;
use super::leg::IncomingRay;
use super::source::TracedLight;
use crate::courses::Both;
use crate::heading::Heading;
use crate::plane_on_leg::PlaneOnLeg;
use crate::proposal::ProfileDensity;
use etendue_field::{Orientation, TwoPlane, VirtualPlane};
use etendue_scene::Scene;

/// A strategy to draw backward rays at one virtual plane.
#[derive(Debug)]
pub(super) struct PlaneSampler {
    pub(super) leg: usize,
    pub(super) planes_on_leg: Both<PlaneOnLeg>,
    pub(super) position: [ProfileDensity; 2],
    pub(super) slope: [ProfileDensity; 2],
    /// Whether slopes are drawn towards points of the light. This is the case if the light
    /// restricts slopes more than the window does.
    pub(super) to_light: bool,
}

impl PlaneSampler {
    pub(super) fn new(
        scene: &Scene,
        index: usize,
        plane: &VirtualPlane,
        light: &TracedLight,
    ) -> Self {
        let w = &plane.window;
        let narrower = match light {
            TracedLight::Area { shape, .. } => {
                let bounds = shape.bounds();
                let slopes = |axis: usize| bounds.size[axis] / plane.distance;
                slopes(0) * slopes(1) < 4.0 * w.u.half_width() * w.v.half_width()
            }
            TracedLight::Sky(_) => true,
            TracedLight::Narrow(_) => false,
        };
        Self {
            leg: plane.leg,
            planes_on_leg: Both::new(scene, plane.leg, |heading, leg| {
                PlaneOnLeg::of(heading, leg, scene, index, plane)
            }),
            position: [ProfileDensity::new(&w.x), ProfileDensity::new(&w.y)],
            slope: [ProfileDensity::new(&w.u), ProfileDensity::new(&w.v)],
            to_light: plane.leg == 0 && narrower && plane.orientation == Orientation::Orthogonal,
        }
    }

    /// Finds the ray of the leg that has the coordinates `seen` at the virtual plane. Returns this
    /// ray, its end point, and dA / dx dy at the plane; `None` if there is no such ray.
    pub(super) fn leg_ray(&self, seen: &TwoPlane) -> Option<(IncomingRay, End, f64)> {
        let headings = [Heading::Along, Heading::Against];
        headings.into_iter().find_map(|heading| {
            let plane_on_leg = self.planes_on_leg.of(heading)?;
            let (ray, area) = plane_on_leg.leg_ray(seen)?;
            let end = plane_on_leg.crossing(&ray, f64::NEG_INFINITY)?;
            let leg = self.leg;
            let incoming = IncomingRay { leg, heading, ray };
            Some((incoming, End::at_plane(plane_on_leg, end), area))
        })
    }
}
