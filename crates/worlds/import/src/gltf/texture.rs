//! Textures and images of a glTF file.

use super::reader::{Draft, GltfReader};
use crate::pictures;
use crate::range::MAX_NUMBER;
use ::gltf::json::extensions::texture::TextureTransform;
use ::gltf::json::texture::{Info, MagFilter, Sampler, WrappingMode};
use ::gltf::json::validation::Checked;
use etendue_field::Raster;
use etendue_scene::{Channels, Fault};
use etendue_world::{Bitmap, Filter, Texture, Wrap};
use glam::{DAffine2, DMat2, DVec2};
use std::path::Path;
use std::sync::Arc;

/// The texture channel that is read from a pixel.
#[derive(Clone, Copy, Debug)]
pub(super) enum TextureChannel {
    /// The three colour channels, linearised from sRGB, times the given factors.
    Color([f64; 3]),
    /// The second channel is multiplied by a factor, and the product is squared.
    GreenSquared(f64),
    /// The third channel of the pixel times a factor.
    Blue(f64),
    /// Alpha times a factor; if there is a cutoff, this product is replaced by 0 below the cutoff
    /// and by 1 otherwise.
    Alpha { factor: f64, cutoff: Option<f64> },
}

impl GltfReader<'_> {
    /// The texture of a factor, and of the picture that it multiplies, if there is one.
    /// Returns `None` if a cause of refusal was reported.
    pub(super) fn textured(
        &mut self,
        draft: &mut Draft<'_>,
        info: Option<&Info>,
        field: &str,
        level: TextureChannel,
    ) -> Option<Texture> {
        match info {
            Some(info) => self.bitmap(draft, info, field, level),
            None => Some(self.constant(&level)),
        }
    }

    /// The value for a white, opaque pixel, as a constant texture.
    fn constant(&self, level: &TextureChannel) -> Texture {
        Texture::Constant(match *level {
            TextureChannel::Color(factor) => self.color.of(factor),
            TextureChannel::GreenSquared(factor) => factor * factor,
            TextureChannel::Blue(factor) => factor,
            TextureChannel::Alpha { factor, cutoff } => cut(factor, cutoff),
        })
    }

    /// A picture of a material, or `None` if a cause of refusal was reported.
    fn bitmap(
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

    /// The map of a texture transform, which scales, then rotates, then translates.
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

    /// One number for each pixel of an image, or `None` if a cause of refusal was reported.
    fn raster(&mut self, image: usize, level: TextureChannel) -> Option<Arc<Raster>> {
        let key = (image, format!("{level:?}"));
        if let Some(known) = self.rasters.get(&key) {
            return known.clone();
        }
        let read = self.read_image(image, level).map(Arc::new);
        let read = self.accept(&format!("images[{image}]"), read);
        self.rasters.insert(key, read.clone());
        read
    }

    fn read_image(&mut self, number: usize, level: TextureChannel) -> Result<Raster, String> {
        let image = self.root.images.get(number).ok_or("is not there")?;
        let bytes = match (&image.uri, image.buffer_view) {
            (Some(uri), _) => self.bytes_of(uri)?,
            (None, Some(view)) => self.view(view.value()).ok_or("cannot be read")?,
            (None, None) => return Err("has neither uri nor bufferView".to_owned()),
        };
        let extension = extension(&bytes).ok_or("is no PNG or JPEG picture")?;
        let name = Path::new("image").with_extension(extension);
        let channels = pictures::decode(&name, &bytes, self.files)?;
        pictures::counted(self.files, self.numbers_of(&channels, level))
    }

    fn numbers_of(&self, channels: &Channels, level: TextureChannel) -> Result<Raster, Fault> {
        let plain = |level: f64| level;
        match level {
            TextureChannel::Color(factor) => {
                pictures::weighted(channels, self.color, Some(factor), pictures::linear)
            }
            TextureChannel::GreenSquared(factor) => {
                channels.raster(plain, |rgb| (factor * rgb[1]) * (factor * rgb[1]))
            }
            TextureChannel::Blue(factor) => channels.raster(plain, |rgb| factor * rgb[2]),
            TextureChannel::Alpha { factor, cutoff } => {
                channels.alphas(|alpha| cut(factor * alpha, cutoff))
            }
        }
    }
}

/// Returns alpha if there is no cutoff; otherwise returns 0 for alpha below the cutoff, and 1 for
/// all other values.
fn cut(alpha: f64, cutoff: Option<f64>) -> f64 {
    match cutoff {
        Some(cutoff) if alpha >= cutoff => 1.0,
        Some(_) => 0.0,
        None => alpha.clamp(0.0, 1.0),
    }
}

/// The file extension of the format that the first bytes of an image indicate.
fn extension(bytes: &[u8]) -> Option<&'static str> {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => Some("png"),
        [0xff, 0xd8, ..] => Some("jpg"),
        _ => None,
    }
}
