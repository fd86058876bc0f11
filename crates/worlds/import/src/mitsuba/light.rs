//! Emitters that are not surfaces.

use super::mesh::z_of;
use super::object::ObjectRef;
use super::reader::MitsubaReader;
use super::transform::is_rigid;
use etendue_field::{LatLong, Raster};
use etendue_world::{Falloff, Light, SkyMap, Texture};
use glam::{DAffine3, DVec2, DVec3};
use std::f64::consts::PI;
use std::sync::Arc;

/// Plugins supported as lights.
const ALLOWED: &str = "point, spot, projector, directional, constant, envmap, and within a shape area or directionalarea";

/// Default half-angle of a spot, degrees.
const CUTOFF: f64 = 20.0;

impl<'a> MitsubaReader<'a> {
    pub(super) fn light(&mut self, object: ObjectRef<'a>) {
        object.is_used.set(true);
        let light = match object.plugin.as_str() {
            "point" => self.point(object),
            "spot" => self.spot(object),
            "projector" => self.projector(object),
            "directional" => self.directional(object),
            "constant" => self
                .strength(object, "radiance")
                .map(|radiance| Light::Constant { radiance }),
            "envmap" => self.sky(object),
            _ => self.unsupported(object, ALLOWED),
        };
        let is_sky = |light: &Light| matches!(light, Light::Constant { .. } | Light::Sky(_));
        if light.as_ref().is_some_and(is_sky) && self.world.lights.iter().any(is_sky) {
            return object.cause("a second environment; allowed: one, as in Mitsuba 3");
        }
        match light {
            Some(light) => self.world.lights.push(light),
            None => self.lost(object),
        }
    }

    fn point(&mut self, object: ObjectRef<'a>) -> Option<Light> {
        let of = |map: DAffine3| Some(map.translation);
        let position = self.either(object, "position", DVec3::ZERO, of);
        let intensity = self.strength(object, "intensity");
        Some(Light::Point {
            position: position?,
            intensity: intensity?,
        })
    }

    fn directional(&mut self, object: ObjectRef<'a>) -> Option<Light> {
        let direction = self.either(object, "direction", DVec3::Z, z_of);
        let irradiance = self.strength(object, "irradiance");
        let direction = direction?.try_normalize();
        if direction.is_none() {
            object.cause("a direction of length 0");
        }
        Some(Light::Directional {
            direction: direction?,
            irradiance: irradiance?,
        })
    }

    /// A vector, which is given either directly or by a transform, or `default` if neither
    /// is given. Returns `None` if a cause of refusal was reported.
    fn either(
        &self,
        object: ObjectRef<'a>,
        name: &str,
        default: DVec3,
        of: impl Fn(DAffine3) -> Option<DVec3>,
    ) -> Option<DVec3> {
        match [name, "to_world"].map(|name| object.has(name)) {
            [true, true] => {
                let message =
                    format!("{name} is given together with to_world; allowed: one of them");
                object.refuse(message)
            }
            [true, false] => object.vector(name),
            [false, true] => of(object.transform("to_world")?)
                .or_else(|| object.refuse("to_world gives no direction")),
            [false, false] => Some(default),
        }
    }

    fn spot(&mut self, object: ObjectRef<'a>) -> Option<Light> {
        let picture = match object.property("texture") {
            Some(_) => self.reflectance(object, "texture", 1.0).map(Some),
            None => Some(None),
        };
        let intensity = self.strength(object, "intensity");
        let angle = |name, default| {
            let is_angle = |a| (0.0..=90.0).contains(&a);
            object.number_or(name, default, "0 to 90 degrees", is_angle)
        };
        let cutoff = angle("cutoff_angle", CUTOFF);
        let beam = angle("beam_width", cutoff.unwrap_or(CUTOFF) * 0.75);
        let rigid = self.rigid(object);
        let (cutoff, beam) = (cutoff?, beam?);
        if beam >= cutoff {
            let message = format!("beam_width is {beam}; allowed: below cutoff_angle, {cutoff}");
            return object.refuse(message);
        }
        Some(Light::Spot {
            to_world: rigid?,
            intensity: intensity?,
            beam: beam.to_radians(),
            cutoff: cutoff.to_radians(),
            falloff: Falloff::Angle,
            picture: picture?,
        })
    }

    fn projector(&mut self, object: ObjectRef<'a>) -> Option<Light> {
        let picture = self.emission(object, "irradiance");
        let scale = self.scale(object);
        let rigid = self.rigid(object);
        let picture = picture?;
        let size = match &picture {
            Texture::Bitmap(bitmap) => [bitmap.pixels.width(), bitmap.pixels.height()],
            _ => [1, 1],
        };
        let half = self.half_width(object, size)?;
        Some(Light::Projector {
            to_world: rigid?,
            half: DVec2::new(half, half * size[1] as f64 / size[0] as f64),
            picture,
            // Mitsuba states the irradiance of a plane at distance 1, divided by π.
            scale: PI * scale?,
        })
    }

    fn sky(&mut self, object: ObjectRef<'a>) -> Option<Light> {
        let scale = self.scale(object);
        let to_world = self.rigid(object);
        let pixels = self.picture(object, false)?;
        let (scale, to_world) = (scale?, to_world?);
        if pixels.values().iter().any(|v| *v < 0.0) {
            return object.refuse("the picture has pixels below 0; allowed: 0 or more");
        }
        let spent = self.files.spend(size_of_val(pixels.values()) as u64);
        self.report.accept(&object.place, spent)?;
        let values = pixels.values().iter().map(|v| v * scale).collect();
        let radiance = Raster::new(pixels.width(), pixels.height(), values)?;
        Some(Light::Sky(SkyMap {
            to_world: to_world.matrix3,
            radiance: Arc::new(LatLong::from_pole_to_pole(radiance)),
        }))
    }

    /// The factor on the picture of a projector or of an environment.
    fn scale(&self, object: ObjectRef<'a>) -> Option<f64> {
        object.number_or("scale", 1.0, "0 or more", |s| s >= 0.0)
    }

    /// Returns `to_world`, which must preserve lengths and angles, or `None` if a cause of refusal
    /// was reported.
    pub(super) fn rigid(&self, object: ObjectRef<'a>) -> Option<DAffine3> {
        if !object.has("to_world") {
            return Some(DAffine3::IDENTITY);
        }
        let map = object.transform("to_world")?;
        if is_rigid(map) {
            return Some(map);
        }
        let message = "to_world scales or shears; allowed: rotations, translations and reflections";
        object.fault("to_world", message)
    }
}
