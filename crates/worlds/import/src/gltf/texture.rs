//! Textures of a glTF file, and the placement of these textures.

use super::level::{TextureChannel, cut};
use super::reader::GltfReader;
use super::surface::Draft;
use crate::range::MAX_NUMBER;
use ::gltf::json::extensions::texture::TextureTransform;
use ::gltf::json::texture::{Info, MagFilter, Sampler, WrappingMode};
use ::gltf::json::validation::Checked;
use etendue_world::{Bitmap, Filter, Texture, Wrap};
use glam::{DAffine2, DMat2, DVec2};

impl GltfReader<'_> {
    /// Returns the value for a white, opaque pixel, as a constant texture.
    pub(super) fn constant(&self, level: &TextureChannel) -> Texture {
        Texture::Constant(match *level {
            TextureChannel::Color(factor) => self.color.of(factor),
            TextureChannel::GreenSquared(factor) => factor * factor,
            TextureChannel::Blue(factor) => factor,
            TextureChannel::Alpha { factor, cutoff } => cut(factor, cutoff),
        })
    }

    /// Returns a picture of a material, or `None` if a cause of refusal was reported.
    pub(super) fn bitmap(
        &mut self,
        draft: &mut Draft<'_>,
        info: &Info,
        field: &str,
        level: TextureChannel,
    ) -> Option<Texture> {
        let path = format!("{}.{field}", draft.path);
        let texture = self.root.get(info.index)?;
        let extensions = info.extensions.as_ref();
        let transform = extensions.and_then(|of| of.texture_transform.as_ref());
        let set = transform.and_then(|of| of.tex_coord);
        draft.sets.insert(set.unwrap_or(info.tex_coord));
        let to_uv = match transform {
            Some(transform) => self.to_uv(transform, &path)?,
            None => DAffine2::IDENTITY,
        };
        let sampler = texture.sampler.and_then(|sampler| self.root.get(sampler));
        let (wrap, filter) = self.sampler(sampler, &path);
        let filter = match level {
            // Alpha with a cutoff is 0 or 1, and is not interpolated between pixels.
            TextureChannel::Alpha {
                cutoff: Some(_), ..
            } => Filter::Nearest,
            _ => filter,
        };
        let pixels = self.raster(texture.source.value(), level)?;
        Some(Texture::Bitmap(Bitmap {
            to_uv,
            pixels,
            wrap,
            filter,
        }))
    }

    fn sampler(&self, sampler: Option<&Sampler>, path: &str) -> (Wrap, Filter) {
        let Some(sampler) = sampler else {
            return (Wrap::Repeat, Filter::Bilinear);
        };
        let wrap = |mode| match mode {
            Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
            Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
            _ => Wrap::Repeat,
        };
        let [across, down] = [wrap(sampler.wrap_s), wrap(sampler.wrap_t)];
        if across != down {
            let message = format!(
                "approximated: wrapS, {across:?}, is used in both directions, and wrapT, {down:?}, is left out"
            );
            self.note(path, message);
        }
        let filter = match sampler.mag_filter {
            Some(Checked::Valid(MagFilter::Nearest)) => Filter::Nearest,
            _ => Filter::Bilinear,
        };
        (across, filter)
    }

    /// Returns the map of a texture transform, which scales, then rotates, then translates.
    /// Rotations follow the Khronos viewer and three.js: u' = u cos r + v sin r.
    fn to_uv(&self, of: &TextureTransform, path: &str) -> Option<DAffine2> {
        let [scale, offset] = [of.scale.0, of.offset.0].map(|v| DVec2::from(v.map(f64::from)));
        let (sine, cosine) = libm::sincos(f64::from(of.rotation.0));
        let turn = DMat2::from_cols(DVec2::new(cosine, -sine), DVec2::new(sine, cosine));
        let linear = turn * DMat2::from_diagonal(scale);
        let map = DAffine2::from_mat2_translation(linear, offset);
        let is_in_range = map.to_cols_array().iter().all(|v| v.abs() <= MAX_NUMBER);
        if !is_in_range {
            let message = format!("is transformed out of range; allowed: up to {MAX_NUMBER:e}");
            self.cause(path, message);
        }
        is_in_range.then_some(map)
    }
}
