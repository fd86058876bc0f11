//! Emission of surfaces.

use super::entity::{Entity, Read};
use super::imagemap::{default_curve, upside_down};
use super::keys::Uv;
use super::reader::PbrtReader;
use super::scene::PbrtShape;
use super::shape::PbrtSurface;
use etendue_world::{Bitmap, EmittedRadiance, Filter, Texture, Wrap};
use std::f64::consts::PI;

impl PbrtReader<'_> {
    /// Returns the emission of a shape before it is scaled to a required power.
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
            self.note_once(&area.place, message);
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

    /// Returns the emission of a surface whose radiance is given by a picture.
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

    /// Returns the emission scaled to the required power. As in pbrt, the area of the shape is
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
