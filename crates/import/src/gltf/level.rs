//! The texture channel that is read from a pixel.

/// The texture channel that is read from a pixel.
#[derive(Clone, Copy, Debug)]
pub(super) enum TextureChannel {
    /// A linearised sRGB colour, times these factors.
    Color([f64; 3]),
    /// The square of the second channel times a factor.
    GreenSquared(f64),
    /// The third channel times a factor.
    Blue(f64),
    /// Alpha times a factor; with a cutoff, the value is 0 or 1.
    Alpha { factor: f64, cutoff: Option<f64> },
}

/// Alpha, or 0 or 1 depending on the cutoff.
pub(super) fn cut(alpha: f64, cutoff: Option<f64>) -> f64 {
    match cutoff {
        Some(cutoff) if alpha >= cutoff => 1.0,
        Some(_) => 0.0,
        None => alpha.clamp(0.0, 1.0),
    }
}
