//! The texture channel that is read from a pixel.

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

/// Returns alpha if there is no cutoff; otherwise returns 0 for alpha below the cutoff, and 1 for
/// all other values.
pub(super) fn cut(alpha: f64, cutoff: Option<f64>) -> f64 {
    match cutoff {
        Some(cutoff) if alpha >= cutoff => 1.0,
        Some(_) => 0.0,
        None => alpha.clamp(0.0, 1.0),
    }
}
