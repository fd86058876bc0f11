//! Lights, and the emission of surfaces.

use super::entity::{Entity, Read};
use super::reader::{PbrtReader, Uv};
use super::scene::PbrtShape;
use super::shape::PbrtSurface;
use super::texture::{default_curve, upside_down};
use super::transform::without_scale;
use crate::range::{MAX_NUMBER, in_range};
use crate::spectrum::Role;
use etendue_world::{Bitmap, EmittedRadiance, Falloff, Filter, Light, Texture, Wrap};
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

    /// The colour of a light times its scale.
    fn strength(&self, entity: &Entity<'_>, name: &str) -> Read<f64> {
        let color = self.number_of(entity, name, Role::Emission);
        let scale = self.scale_of(entity)?;
        Ok(color?.unwrap_or(1.0) * scale)
    }

    pub(super) fn scale_of(&self, entity: &Entity<'_>) -> Read<f64> {
        entity.float_within("scale", 1.0, "0 or more", |v| v >= 0.0)
    }

    /// The factor that gives a light its required power or illuminance. As in pbrt, powers
    /// and illuminances of 0 or less are ignored.
    pub(super) fn wanted(&self, entity: &Entity<'_>, name: &str, now: f64) -> Read<f64> {
        let wanted = entity.float(name)?;
        let factor = wanted.filter(|w| *w > 0.0).map_or(1.0, |w| w / now);
        in_range(factor)
            .map_err(|error| entity.fault(name, format!("the factor for {name}: {error}")))
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
        Err(entity.refuse("a place out of range; allowed: coordinates up to 1e9"))
    }

    /// The vector from the point `from` to the point `to`, in world coordinates.
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
            return Err(entity.refuse("the spot has shear, or different scales along its axes"));
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
            return Err(entity.fault("portal", "portals are not supported"));
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

    /// The emission of a shape before it is scaled to a required power.
    pub(super) fn shape_emission(
        &mut self,
        shape: &PbrtShape<'_>,
        uv: Uv,
        is_in_object: bool,
    ) -> Read<Option<EmittedRadiance>> {
        let Some(area) = shape.area.map(|area| &self.scene.areas[area]) else {
            return Ok(None);
        };
        area.is_used.set(true);
        if is_in_object {
            let message = "left out, as in pbrt: area lights in an object";
            self.report.note_once(&area.place, message);
            return Ok(None);
        }
        if area.plugin != "diffuse" {
            return Err(area.unsupported("diffuse"));
        }
        if shape.entity.has("alpha") {
            let message = "alpha of a shape that emits light is not supported";
            return Err(shape.entity.fault("alpha", message));
        }
        match area.has("filename") {
            true => self.shown(area, uv).map(Some),
            false => Ok(Some(Texture::Constant(self.strength(area, "L")?))),
        }
    }

    /// The emission of a surface whose radiance is given by a picture.
    fn shown(&mut self, area: &Entity<'_>, uv: Uv) -> Read<EmittedRadiance> {
        for name in ["L", "power"] {
            if area.has(name) {
                let message = format!("{name} together with filename is not supported");
                return Err(area.fault(name, message));
            }
        }
        let scale = self.scale_of(area);
        let curve = default_curve(self.file_name(area)?);
        let pixels = self.picture(area, curve)?;
        let scale = scale?;
        Ok(Texture::Bitmap(Bitmap {
            to_uv: upside_down() * uv.to_pbrt(),
            pixels: self.mapped_pixels(area, &pixels, |v| scale * v.max(0.0))?,
            wrap: Wrap::Clamp,
            filter: Filter::Bilinear,
        }))
    }

    /// The emission scaled to the required power. As in pbrt, the area of the shape is
    /// taken before the transform, except that the area of triangles is taken after the transform.
    pub(super) fn powered(
        &self,
        area: Option<&Entity<'_>>,
        emission: Option<EmittedRadiance>,
        surface: &PbrtSurface,
    ) -> Read<Option<EmittedRadiance>> {
        let (Some(area), Some(Texture::Constant(radiance))) = (area, &emission) else {
            return Ok(emission);
        };
        let has_power = area.float("power")?.is_some_and(|p| p > 0.0);
        match surface.area {
            Some(size) => {
                let sides = f64::from(1 + u8::from(area.truth("twosided", false)?));
                let factor = self.wanted(area, "power", sides * PI * size)?;
                Ok(Some(Texture::Constant(radiance * factor)))
            }
            None if has_power => {
                let message = "power of a mesh of several triangles: pbrt gives this power to each triangle; allowed: a mesh of one triangle";
                Err(area.fault("power", message))
            }
            None => Ok(emission),
        }
    }
}
