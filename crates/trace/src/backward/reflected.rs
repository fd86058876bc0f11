//! Light that a surface with a BRDF reflects, from one direction it may have come from.

use super::{Backward, Incoming, Source, connection};
use crate::brdf;
use crate::emit::point;
use crate::obstacles::direction;
use etendue_field::{Frame, Mixture};
use glam::DVec3;

/// A point at which light is reflected, in the frame at the light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reflection<'a> {
    pub(super) brdf: Mixture<'a>,
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
        at: &Reflection<'_>,
        block: u32,
        words: &impl Fn(u32) -> [f64; 4],
    ) -> f64 {
        let r = words(block);
        let Reflection {
            brdf, frame, to, ..
        } = at;
        let sees_light = self.legs[leg].courses.along.leaves.is_none();
        if let (Source::Narrow(light), true) = (&self.light, sees_light) {
            return connection(light, at.point).map_or(0.0, |(ray, irradiance)| {
                let from = frame.vector_to_local(-direction(&ray).normalize());
                let carried = brdf::sum(brdf, from, *to) * from.z.max(0.0);
                let incoming = Incoming::from_light(ray);
                let found = self.arriving(&incoming, at.point.z, block + 1, words);
                carried * irradiance * found
            });
        }
        let from = if sees_light && r[2] < 0.5 {
            let towards = match &self.light {
                Source::Area { shape, .. } => {
                    let [x, y] = point(shape, [r[0], r[1]]);
                    DVec3::new(x, y, 0.0) - at.point
                }
                Source::Narrow(_) => return 0.0,
                Source::Sky(sky) => -sky.sample([r[0], r[1], 2.0 * r[2], r[3]]),
            };
            frame.vector_to_local(towards).normalize()
        } else {
            brdf::towards(brdf, *to, [r[0], r[1]])
        };
        let carried = brdf::sum(brdf, from, *to) * from.z;
        let towards = frame.vector_to_world(from);
        let by_lobe = brdf::densities(brdf, *to, from);
        let density = if sees_light {
            0.5 * (by_lobe + self.light.density_towards(at.point, towards))
        } else {
            by_lobe
        };
        if carried > 0.0 {
            carried / density * self.along(leg, at.point, -towards, block + 1, words)
        } else {
            0.0
        }
    }
}

impl Source {
    /// The density per solid angle, at a point, of directions drawn towards the light.
    fn density_towards(&self, point: DVec3, towards: DVec3) -> f64 {
        let shape = match self {
            Self::Sky(sky) => return sky.density(-towards),
            Self::Area { shape, .. } => shape,
            Self::Narrow(_) => return 0.0,
        };
        let way = -point.z / towards.z;
        let on = point + way * towards;
        let is_on = way > 0.0 && shape.contains(on.x, on.y);
        // r² dω = cos θ dA.
        if is_on {
            way * way / (towards.z.abs() * shape.area())
        } else {
            0.0
        }
    }
}
