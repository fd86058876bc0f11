//! Pictures on surfaces.

use super::entity::{Entity, Read};
use super::keys::Uv;
use super::reader::PbrtReader;
use super::texture::Ask;
use crate::pictures::TransferCurve;
use crate::report::quoted;
use crate::spectrum::Role;
use etendue_field::Raster;
use etendue_world::{Bitmap, Filter, Texture, Wrap};
use glam::{DAffine2, DMat2, DVec2};
use std::path::Path;
use std::sync::Arc;

impl PbrtReader<'_> {
    pub(super) fn imagemap(&mut self, entity: &Entity, ask: Ask, uv: Uv) -> Read<Texture> {
        let report = self.report;
        let to_uv = self.mapping(entity, uv);
        let wraps = [("repeat", Wrap::Repeat), ("clamp", Wrap::Clamp)];
        let wrap = entity.choice(report, "wrap", &wraps);
        let filter = self.filter(entity);
        let scale = entity.float_or(report, "scale", 1.0);
        let inverts = entity.truth(report, "invert", false);
        let pixels = self.texels(entity)?;
        let (scale, inverts) = (scale?, inverts?);
        let clamps = ask == Ask::Spectrum(Role::Reflectance);
        let of = |v: f64| {
            let v = scale * v;
            let v = if inverts { 1.0 - v } else { v }.max(0.0);
            if clamps { v.min(1.0) } else { v }
        };
        let is_changed = pixels.values().iter().any(|v| (of(*v) - v).abs() > 0.0);
        let pixels = match is_changed {
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

    fn filter(&self, entity: &Entity) -> Read<Filter> {
        let filters = [
            ("bilinear", (Filter::Bilinear, false)),
            ("point", (Filter::Nearest, false)),
            ("trilinear", (Filter::Bilinear, true)),
            ("ewa", (Filter::Bilinear, true)),
            ("EWA", (Filter::Bilinear, true)),
        ];
        let (filter, is_near) = entity.choice(self.report, "filter", &filters)?;
        if is_near {
            let message =
                "filter is approximated by bilinear interpolation of the picture at its full size";
            self.note_once(entity.place_of("filter"), message);
        }
        Ok(filter)
    }

    fn texels(&mut self, entity: &Entity) -> Read<Arc<Raster>> {
        let is_png = |name: &str| {
            let extension = Path::new(name).extension();
            extension.is_some_and(|e| e.eq_ignore_ascii_case("png"))
        };
        let name = self.file_name(entity)?;
        let curve = match entity.text(self.report, "encoding")? {
            None if is_png(name) => TransferCurve::Srgb,
            None | Some("linear") => TransferCurve::Linear,
            Some("sRGB") => TransferCurve::Srgb,
            Some(other) => gamma(other).ok_or_else(|| {
                let other = quoted(other);
                let message = format!("encoding is {other}; allowed: linear, sRGB, gamma NUMBER");
                entity.fault(self.report, "encoding", message)
            })?,
        };
        self.picture(entity, curve)
    }

    /// Returns the picture given by `filename`.
    pub(super) fn picture(&mut self, entity: &Entity, curve: TransferCurve) -> Read<Arc<Raster>> {
        let name = self.file_name(entity)?;
        let found = self.find(name);
        let read =
            found.and_then(|path| self.pictures.read_by(self.files, &path, self.color, curve));
        read.map_err(|error| self.unread(entity, name, &error))
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
