//! Keys of rasters in a cache, so that each raster is made only once.

use super::level::TextureChannel;

/// An image, and the channel that is read from it.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct RasterKey {
    image: usize,
    kind: u8,
    numbers: [u64; 3],
}

impl RasterKey {
    pub(super) fn new(image: usize, level: TextureChannel) -> Self {
        let (kind, numbers) = match level {
            TextureChannel::Color(factor) => (0, factor),
            TextureChannel::GreenSquared(factor) => (1, [factor, 0.0, 0.0]),
            TextureChannel::Blue(factor) => (2, [factor, 0.0, 0.0]),
            TextureChannel::Alpha { factor, cutoff } => (3, [factor, cutoff.unwrap_or(-1.0), 0.0]),
        };
        Self {
            image,
            kind,
            numbers: numbers.map(f64::to_bits),
        }
    }
}
