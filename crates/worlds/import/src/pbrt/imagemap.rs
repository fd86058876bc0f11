//! Pictures on surfaces.

use super::entity::{Entity, Read};
use super::keys::Uv;
use super::reader::PbrtReader;
use super::texture::Ask;
use crate::files::has_extension;
use crate::pictures::TransferCurve;
use crate::report::quoted;
use crate::spectrum::Role;
use etendue_field::Raster;
use etendue_world::{Bitmap, Filter, Texture, Wrap};
use glam::{DAffine2, DMat2, DVec2};
use std::path::Path;
use std::sync::Arc;

impl PbrtReader<'_> {
    pub(super) fn imagemap(&mut self, entity: &Entity<'_>, ask: Ask, uv: Uv) -> Read<Texture> {
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
            self.note_once(&entity.place, message);
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
            self.note_once(entity.place_of("filter"), message);
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

    /// Returns the picture given by `filename`.
    pub(super) fn picture(
        &mut self,
        entity: &Entity<'_>,
        curve: TransferCurve,
    ) -> Read<Arc<Raster>> {
        let name = self.file_name(entity)?;
        let found = self.find(name);
        let read =
            found.and_then(|path| self.pictures.read_by(self.files, &path, self.color, curve));
        read.map_err(|error| self.unread(entity, name, &error))
    }
}

/// Returns the curve of a picture whose encoding is not given: only PNG files are sRGB.
pub(super) fn default_curve(name: &str) -> TransferCurve {
    match has_extension(Path::new(name), "png") {
        true => TransferCurve::Srgb,
        false => TransferCurve::Linear,
    }
}

/// Returns the map that flips v. In the pictures of pbrt, v points upwards; in the pictures of a
/// world, v points downwards.
pub(super) fn upside_down() -> DAffine2 {
    let linear = DMat2::from_diagonal(DVec2::new(1.0, -1.0));
    DAffine2::from_mat2_translation(linear, DVec2::Y)
}

fn gamma(text: &str) -> Option<TransferCurve> {
    let exponent = text.strip_prefix("gamma")?.trim().parse::<f64>().ok()?;
    (exponent.is_finite() && exponent > 0.0).then_some(TransferCurve::Gamma(exponent))
}
