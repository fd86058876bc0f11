//! Lights that are not surfaces.

use super::entity::{CauseGiven, Entity, Read};
use super::reader::PbrtReader;
use super::transform::without_scale;
use crate::range::{MAX_NUMBER, in_range};
use crate::spectrum::Role;
use etendue_world::{Falloff, Light};
use glam::{DAffine3, DMat3, DVec3};
use std::f64::consts::PI;

/// Plugins supported as lights.
const ALLOWED: &str = "point, spot, distant, infinite";

impl PbrtReader<'_> {
    pub(super) fn light(&mut self, entity: &Entity<'_>, to_world: DAffine3) {
        entity.is_used.set(true);
        let light = match entity.plugin.as_str() {
            "point" => self.point(entity, to_world),
            "spot" => self.spot(entity, to_world),
            "distant" => self.distant(entity, to_world),
            "infinite" => self.infinite(entity, to_world),
            _ => Err(entity.unsupported(ALLOWED)),
        };
        if let Ok(light) = light {
            self.world.lights.push(light);
        }
    }

    /// Returns the colour of a light times its scale.
    pub(super) fn strength(&self, entity: &Entity<'_>, name: &str) -> Read<f64> {
        let color = self.number_of(entity, name, Role::Emission);
        let scale = self.scale_of(entity)?;
        Ok(color?.unwrap_or(1.0) * scale)
    }

    pub(super) fn scale_of(&self, entity: &Entity<'_>) -> Read<f64> {
        entity.float_within("scale", 1.0, "0 or more", |v| v >= 0.0)
    }

    /// Returns the factor that gives a light its required power or illuminance. As in pbrt, powers
    /// and illuminances of 0 or less are ignored.
    pub(super) fn wanted(&self, entity: &Entity<'_>, name: &str, now: f64) -> Read<f64> {
        let wanted = entity.float(name)?;
        let factor = wanted.filter(|w| *w > 0.0).map_or(1.0, |w| w / now);
        in_range(factor).map_err(|error| {
            let message = format!("the factor for {name}: {error}");
            entity.fault(name, message)
        })
    }

    fn point(&self, entity: &Entity<'_>, to_world: DAffine3) -> Read<Light> {
        let strength = self.strength(entity, "I");
        let factor = self.wanted(entity, "power", 4.0 * PI);
        let from = entity.point_or("from", DVec3::ZERO);
        Ok(Light::Point {
            position: self.place(entity, to_world.transform_point3(from?))?,
            intensity: strength? * factor?,
        })
    }

    /// Adds a cause if a position is out of range.
    fn place(&self, entity: &Entity<'_>, place: DVec3) -> Read<DVec3> {
        if place.abs().max_element() <= MAX_NUMBER {
            return Ok(place);
        }
        self.report.cause(
            &entity.place,
            "a place out of range; allowed: coordinates up to 1e9",
        );
        Err(CauseGiven)
    }

    /// Returns the vector from the point `from` to the point `to`, in world coordinates.
    fn way(&self, entity: &Entity<'_>, to_world: DAffine3) -> Read<DVec3> {
        let from = entity.point_or("from", DVec3::ZERO);
        let to = entity.point_or("to", DVec3::Z);
        let way = to_world.transform_vector3(to? - from?).try_normalize();
        way.ok_or_else(|| entity.refuse("a direction of length 0"))
    }

    fn distant(&self, entity: &Entity<'_>, to_world: DAffine3) -> Read<Light> {
        let strength = self.strength(entity, "L");
        let factor = self.wanted(entity, "illuminance", 1.0);
        Ok(Light::Directional {
            direction: self.way(entity, to_world)?,
            irradiance: strength? * factor?,
        })
    }

    fn spot(&self, entity: &Entity<'_>, to_world: DAffine3) -> Read<Light> {
        let strength = self.strength(entity, "I");
        let angle = |name, default| {
            let is_angle = |a| (0.0..=180.0).contains(&a);
            entity.float_within(name, default, "0 to 180 degrees", is_angle)
        };
        let (cutoff, delta) = (angle("coneangle", 30.0), angle("conedeltaangle", 5.0));
        let from = entity.point_or("from", DVec3::ZERO);
        let way = self.way(entity, to_world);
        if without_scale(to_world).is_none() {
            let message = "the spot has shear, or different scales along its axes";
            return Err(entity.refuse(message));
        }
        let (cutoff, delta) = (cutoff?, delta?);
        if delta > cutoff {
            let message = format!("conedeltaangle is {delta}; allowed: 0 to coneangle, {cutoff}");
            return Err(entity.fault("conedeltaangle", message));
        }
        let [cutoff, beam] = [cutoff, cutoff - delta].map(f64::to_radians);
        let [end, start] = [cutoff, beam].map(libm::cos);
        // As in pbrt, the falloff between both cones, averaged over the cosine, is assumed to be
        // one half.
        let solid = 2.0 * PI * ((1.0 - start) + (start - end) / 2.0);
        let factor = self.wanted(entity, "power", solid)?;
        let along = way?;
        let across = along.any_orthonormal_vector();
        let frame = DMat3::from_cols(across, along.cross(across), along);
        let position = self.place(entity, to_world.transform_point3(from?))?;
        Ok(Light::Spot {
            to_world: DAffine3::from_mat3_translation(frame, position),
            intensity: strength? * factor,
            beam,
            cutoff,
            falloff: Falloff::SmoothCosine,
            picture: None,
        })
    }

    fn infinite(&mut self, entity: &Entity<'_>, to_world: DAffine3) -> Read<Light> {
        if entity.has("portal") {
            let message = "portals are not supported";
            return Err(entity.fault("portal", message));
        }
        if entity.has("filename") {
            return self.sky(entity, to_world);
        }
        let strength = self.strength(entity, "L");
        let factor = self.wanted(entity, "illuminance", PI);
        Ok(Light::Constant {
            radiance: strength? * factor?,
        })
    }
}
