//! Light that a surface with a BRDF reflects, from one direction it may have come from.

use super::Backward;
use crate::brdf;
use crate::emit::point;
use crate::obstacles::{direction, ray_through, start};
use etendue_field::{Brdf, Frame, Side, TwoPlane};
use glam::DVec3;

/// A point at which light is reflected, in the frame at the light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reflection {
    pub(super) brdf: Brdf,
    pub(super) point: DVec3,
    /// D along the normal.
    pub(super) frame: Frame,
    /// Where light goes, of unit length, in that frame.
    pub(super) to: DVec3,
}

impl Backward {
    /// The radiance that is reflected at the end of a leg, from one direction: drawn by the lobe, or towards a point of the light where the leg
    /// begins there, in equal parts; both have the density of the mixture (the balance heuristic of Veach and Guibas 1995 for one sample).
    pub(super) fn reflected(
        &self,
        leg: usize,
        at: &Reflection,
        block: u32,
        words: &impl Fn(u32) -> [f64; 4],
    ) -> f64 {
        let r = words(block);
        let Reflection {
            brdf, frame, to, ..
        } = at;
        let this = &self.legs[leg];
        let sees_light = this.leaves.is_none();
        let from = if sees_light && r[2] < 0.5 {
            let [x, y] = point(&self.light.shape, [r[0], r[1]]);
            let way = DVec3::new(x, y, 0.0) - at.point;
            frame.vector_to_local(way).normalize()
        } else {
            brdf::sample(brdf, *to, [r[0], r[1]])
        };
        let carried = brdf::value(brdf, from, *to) * from.z;
        let towards = frame.vector_to_world(from);
        let end = this.frame.to_local(at.point);
        let came = this.frame.vector_to_local(-towards);
        let Some(ray) = ray_through(end, came).filter(|_| carried > 0.0) else {
            return 0.0;
        };
        if self.hides_itself(leg, &ray, end.z) {
            return 0.0;
        }
        let by_lobe = brdf::density(brdf, *to, from);
        let density = if sees_light {
            0.5 * (by_lobe + self.density_towards_light(at.point, towards))
        } else {
            by_lobe
        };
        carried / density * self.incident(leg, &ray, end.z, Side::Before, block + 1, words)
    }

    /// The density per solid angle, at a point, of directions to uniform points of the light.
    fn density_towards_light(&self, point: DVec3, towards: DVec3) -> f64 {
        let way = -point.z / towards.z;
        let on = point + way * towards;
        let is_on = way > 0.0 && self.light.shape.contains(on.x, on.y);
        // r² dω = cos θ dA.
        if is_on {
            way * way / (towards.z.abs() * self.light.shape.area())
        } else {
            0.0
        }
    }

    /// Whether the patch that a leg ends on stands in the way of light to its own point at `end`.
    fn hides_itself(&self, leg: usize, ray: &TwoPlane, end: f64) -> bool {
        let this = &self.legs[leg];
        let Some(patch) = &this.end else {
            return false;
        };
        let begin = match &this.leaves {
            None => 0.0,
            Some(leaves) => leaves.targets.last(ray).map_or(end, |(at, _)| at),
        };
        let hits = patch.hits(
            patch.frame.to_local(start(ray)),
            patch.frame.vector_to_local(direction(ray)),
        );
        let nearer = |at: &f64| *at > begin && *at < end - ROUNDING * (end - begin);
        hits.iter().any(nearer)
    }
}

/// Share of a way by which a point that is met again is off.
const ROUNDING: f64 = 1e-9;
