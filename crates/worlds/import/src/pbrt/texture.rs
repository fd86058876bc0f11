//! Numbers that may vary over a surface: values, spectra and textures.

use super::entity::{CauseGiven, Entity, Read};
use super::reader::{Ask, PbrtReader, Uv};
use crate::files::has_extension;
use crate::pictures::TransferCurve;
use crate::range::share;
use crate::report::quoted;
use crate::spectrum::Role;
use etendue_field::Raster;
use etendue_world::{Bitmap, Filter, Texture, Wrap};
use glam::{DAffine2, DMat2, DVec2};
use std::path::Path;
use std::sync::Arc;

/// Maximum nesting depth of textures.
const MAX_DEPTH: usize = 16;

/// Plugins supported as textures.
const ALLOWED: &str = "constant, imagemap, checkerboard, scale, mix";

impl PbrtReader<'_> {
    /// The texture of a parameter, or a constant if the parameter is missing.
    pub(super) fn texture_or(
        &mut self,
        entity: &Entity<'_>,
        name: &str,
        ask: Ask,
        default: f64,
        uv: Uv,
    ) -> Read<Texture> {
        let Some(parameter) = entity.find(name) else {
            return Ok(Texture::Constant(default));
        };
        if parameter.kind == "texture" {
            let asked = entity.texture_name(name)?;
            return self.named_texture(entity, name, asked, ask, uv);
        }
        match ask {
            Ask::Float => entity.float_or(name, default).map(Texture::Constant),
            Ask::Spectrum(role) => {
                let value = self.number_of(entity, name, role)?;
                Ok(Texture::Constant(value.unwrap_or(default)))
            }
        }
    }

    /// Reads a texture like [`Self::texture_or`], but for an albedo, which must be from 0 to 1.
    pub(super) fn albedo_or(
        &mut self,
        entity: &Entity<'_>,
        name: &str,
        default: f64,
        uv: Uv,
    ) -> Read<Texture> {
        let ask = Ask::Spectrum(Role::Reflectance);
        let texture = self.texture_or(entity, name, ask, default, uv)?;
        share(name, texture).map_err(|message| entity.fault(name, message))
    }

    /// Reads one number; a varying texture is a cause of refusal.
    pub(super) fn constant_or(
        &mut self,
        entity: &Entity<'_>,
        name: &str,
        ask: Ask,
        default: f64,
    ) -> Read<f64> {
        match self.texture_or(entity, name, ask, default, Uv::Own)? {
            Texture::Constant(value) => Ok(value),
            _ => Err(entity.fault(name, format!("{name} varies; allowed: one value"))),
        }
    }

    fn named_texture(
        &mut self,
        asked_by: &Entity<'_>,
        parameter: &str,
        name: &str,
        ask: Ask,
        uv: Uv,
    ) -> Read<Texture> {
        let is_spectrum = ask != Ask::Float;
        let key = (name.to_owned(), ask, uv);
        if let Some(known) = self.textures.get(&key) {
            return known.clone();
        }
        let fault = |message: &str| {
            let message = format!("texture {} {message}", quoted(name));
            asked_by.fault(parameter, message)
        };
        let found = self.scene.textures.get(&(is_spectrum, name.to_owned()));
        let Some(entity) = found else {
            let kind = if is_spectrum { "spectrum" } else { "float" };
            return Err(fault(&format!("is not a known texture of type {kind}")));
        };
        if self.depth >= MAX_DEPTH {
            return Err(fault("contains itself, or too many textures are nested"));
        }
        entity.is_used.set(true);
        self.depth += 1;
        let made = self.make_texture(entity, ask, uv);
        self.depth -= 1;
        self.textures.insert(key, made.clone());
        made
    }

    fn make_texture(&mut self, entity: &Entity<'_>, ask: Ask, uv: Uv) -> Read<Texture> {
        match entity.plugin.as_str() {
            "constant" => self.texture_or(entity, "value", ask, 1.0, uv),
            "checkerboard" => self.checkerboard(entity, ask, uv),
            "scale" => self.scale(entity, ask, uv),
            "mix" => self.mix(entity, ask),
            "imagemap" => self.imagemap(entity, ask, uv),
            _ => Err(entity.unsupported(ALLOWED)),
        }
    }

    /// A checkerboard with squares of one unit. The first value applies where the two
    /// coordinates, rounded down, are both even or both odd.
    fn checkerboard(&mut self, entity: &Entity<'_>, ask: Ask, uv: Uv) -> Read<Texture> {
        if entity.integer_or("dimension", 2)? != 2 {
            return Err(entity.fault("dimension", "a checkerboard has dimension 3; allowed: 2"));
        }
        let first = self.constant_or(entity, "tex1", ask, 1.0);
        let second = self.constant_or(entity, "tex2", ask, 0.0);
        let to_uv = self.mapping(entity, uv)?;
        Ok(Texture::Checkerboard {
            // The scale is one half because in a world the squares are half a unit wide.
            to_uv: DAffine2::from_scale(DVec2::splat(0.5)) * to_uv,
            values: [first?, second?],
        })
    }

    fn scale(&mut self, entity: &Entity<'_>, ask: Ask, uv: Uv) -> Read<Texture> {
        let texture = self.texture_or(entity, "tex", ask, 1.0, uv);
        let scale = self.texture_or(entity, "scale", Ask::Float, 1.0, uv);
        match (texture?, scale?) {
            (Texture::Constant(factor), other) | (other, Texture::Constant(factor)) => {
                self.mapped(entity, other, |v| v * factor)
            }
            _ => {
                let message =
                    "both factors of a product are textures that vary; allowed: one of them";
                Err(entity.fault("tex", message))
            }
        }
    }

    fn mix(&mut self, entity: &Entity<'_>, ask: Ask) -> Read<Texture> {
        let first = self.constant_or(entity, "tex1", ask, 0.0);
        let second = self.constant_or(entity, "tex2", ask, 1.0);
        let amount = self.constant_or(entity, "amount", Ask::Float, 0.5);
        let amount = amount?;
        Ok(Texture::Constant(
            (1.0 - amount) * first? + amount * second?,
        ))
    }

    /// The map from (u, v) of a surface in a world to (u, v) of the texture.
    fn mapping(&self, entity: &Entity<'_>, uv: Uv) -> Read<DAffine2> {
        entity.choice("mapping", &[("uv", ())])?;
        let float = |name, default| entity.float_or(name, default);
        let scale = DVec2::new(float("uscale", 1.0)?, float("vscale", 1.0)?);
        let delta = DVec2::new(float("udelta", 0.0)?, float("vdelta", 0.0)?);
        Ok(DAffine2::from_mat2_translation(DMat2::from_diagonal(scale), delta) * uv.to_pbrt())
    }

    /// A texture with the function `of` applied to each of its values.
    pub(super) fn mapped(
        &self,
        entity: &Entity<'_>,
        texture: Texture,
        of: impl Fn(f64) -> f64,
    ) -> Read<Texture> {
        Ok(match texture {
            Texture::Constant(value) => Texture::Constant(of(value)),
            Texture::Checkerboard { to_uv, values } => Texture::Checkerboard {
                to_uv,
                values: values.map(of),
            },
            Texture::Bitmap(bitmap) => Texture::Bitmap(Bitmap {
                pixels: self.mapped_pixels(entity, &bitmap.pixels, of)?,
                ..bitmap
            }),
            Texture::OfMesh(values) => Texture::OfMesh(values.mapped(of)),
        })
    }

    pub(super) fn mapped_pixels(
        &self,
        entity: &Entity<'_>,
        pixels: &Raster,
        of: impl Fn(f64) -> f64,
    ) -> Read<Arc<Raster>> {
        let bytes = size_of_val(pixels.values()) as u64;
        let spent = self.files.spend(bytes);
        spent.map_err(|error| entity.fault("filename", error))?;
        let values = pixels.values().iter().map(|v| of(*v)).collect();
        let raster = Raster::new(pixels.width(), pixels.height(), values);
        raster.map(Arc::new).ok_or(CauseGiven)
    }

    fn imagemap(&mut self, entity: &Entity<'_>, ask: Ask, uv: Uv) -> Read<Texture> {
        let to_uv = self.mapping(entity, uv);
        let wraps = [("repeat", Wrap::Repeat), ("clamp", Wrap::Clamp)];
        let wrap = entity.choice("wrap", &wraps);
        let filter = self.filter(entity);
        let scale = entity.float_or("scale", 1.0);
        let inverts = entity.truth("invert", false);
        let pixels = self.texels(entity)?;
        let (scale, inverts) = (scale?, inverts?);
        let clamps = ask == Ask::Spectrum(Role::Reflectance);
        let of = |v: f64| {
            let v = scale * v;
            let v = if inverts { 1.0 - v } else { v }.max(0.0);
            if clamps { v.min(1.0) } else { v }
        };
        let pixels = match pixels.values().iter().any(|v| (of(*v) - v).abs() > 0.0) {
            true => self.mapped_pixels(entity, &pixels, of)?,
            false => pixels,
        };
        if ask == Ask::Float {
            let message = "in Étendue, a coloured picture becomes its luminance or one of its channels; in pbrt, it becomes the mean of its channels";
            self.report.note_once(&entity.place, message);
        }
        Ok(Texture::Bitmap(Bitmap {
            to_uv: upside_down() * to_uv?,
            pixels,
            wrap: wrap?,
            filter: filter?,
        }))
    }

    fn filter(&self, entity: &Entity<'_>) -> Read<Filter> {
        let filters = [
            ("bilinear", (Filter::Bilinear, false)),
            ("point", (Filter::Nearest, false)),
            ("trilinear", (Filter::Bilinear, true)),
            ("ewa", (Filter::Bilinear, true)),
            ("EWA", (Filter::Bilinear, true)),
        ];
        let (filter, is_near) = entity.choice("filter", &filters)?;
        if is_near {
            let message =
                "filter is approximated by bilinear interpolation of the picture at its full size";
            self.report.note_once(entity.place_of("filter"), message);
        }
        Ok(filter)
    }

    fn texels(&mut self, entity: &Entity<'_>) -> Read<Arc<Raster>> {
        let name = self.file_name(entity)?;
        let curve = match entity.text("encoding")? {
            None => default_curve(name),
            Some("linear") => TransferCurve::Linear,
            Some("sRGB") => TransferCurve::Srgb,
            Some(other) => gamma(other).ok_or_else(|| {
                let other = quoted(other);
                let message = format!("encoding is {other}; allowed: linear, sRGB, gamma NUMBER");
                entity.fault("encoding", message)
            })?,
        };
        self.picture(entity, curve)
    }

    /// The picture given by `filename`.
    pub(super) fn picture(
        &mut self,
        entity: &Entity<'_>,
        curve: TransferCurve,
    ) -> Read<Arc<Raster>> {
        let name = self.file_name(entity)?;
        let found = self.find(name);
        let read = found.and_then(|path| self.pictures.read(self.files, &path, self.color, curve));
        read.map_err(|error| self.unread(entity, name, &error))
    }
}

/// The curve of a picture whose encoding is not given: only PNG files are sRGB.
pub(super) fn default_curve(name: &str) -> TransferCurve {
    match has_extension(Path::new(name), "png") {
        true => TransferCurve::Srgb,
        false => TransferCurve::Linear,
    }
}

/// The map that flips v. In the pictures of pbrt, v points upwards; in the pictures of a
/// world, v points downwards.
pub(super) fn upside_down() -> DAffine2 {
    let linear = DMat2::from_diagonal(DVec2::new(1.0, -1.0));
    DAffine2::from_mat2_translation(linear, DVec2::Y)
}

fn gamma(text: &str) -> Option<TransferCurve> {
    let exponent = text.strip_prefix("gamma")?.trim().parse::<f64>().ok()?;
    (exponent.is_finite() && exponent > 0.0).then_some(TransferCurve::Gamma(exponent))
}
