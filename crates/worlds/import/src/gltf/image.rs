//! Conversion of images to one number for each pixel.

use super::level::{TextureChannel, cut};
use super::raster_key::RasterKey;
use super::reader::GltfReader;
use crate::pictures;
use etendue_field::Raster;
use etendue_scene::{Channels, Fault};
use std::path::Path;
use std::sync::Arc;

/// Returns the file extension of the format that the first bytes of an image indicate.
fn extension(bytes: &[u8]) -> Option<&'static str> {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => Some("png"),
        [0xff, 0xd8, ..] => Some("jpg"),
        _ => None,
    }
}

impl GltfReader<'_> {
    /// Returns one number for each pixel of an image, or `None` if a cause of refusal was reported.
    pub(super) fn raster(&mut self, image: usize, level: TextureChannel) -> Option<Arc<Raster>> {
        let key = RasterKey::new(image, level);
        if let Some(known) = self.rasters.get(&key) {
            return known.clone().ok();
        }
        let read = self.read_image(image, level).map(Arc::new);
        if let Err(error) = &read {
            self.cause(&format!("images[{image}]"), error);
        }
        self.rasters.insert(key, read.clone());
        read.ok()
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
        let color = self.color;
        let is_grey = channels.is_grey();
        if let TextureChannel::Alpha { factor, cutoff } = level {
            return channels.alphas(|alpha| cut(factor * alpha, cutoff));
        }
        let light = |value: f64| match level {
            TextureChannel::Color(_) => pictures::linear(value),
            _ => value,
        };
        channels.raster(light, |rgb| match level {
            // The value of a grey pixel is used directly, because a luminance computed from three
            // equal values would have a rounding error.
            TextureChannel::Color(factor) if is_grey => rgb[0] * color.of(factor),
            TextureChannel::Color(factor) => color.of([0, 1, 2].map(|i| rgb[i] * factor[i])),
            TextureChannel::GreenSquared(factor) => (factor * rgb[1]) * (factor * rgb[1]),
            TextureChannel::Blue(factor) => factor * rgb[2],
            TextureChannel::Alpha { .. } => 1.0,
        })
    }
}
