//! Patterns that vary over a surface.

use crate::{Grating, Raster};
use serde::{Serialize, Serializer};
use std::sync::Arc;

/// A number from 0 to 1 at each point of a surface.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Pattern {
    /// ½ (1 + m cos(2π f t + p)) along an axis.
    Cosine(Grating),
    /// Alternating 1 and 0 on squares with edges along both axes; the first square beyond the
    /// vertex along both axes has the value 1.
    Checkerboard {
        /// The period: the length of two sides of a square, in metres.
        period: f64,
    },
    /// A picture around the vertex.
    Picture(Picture),
}

/// A picture on a surface. Its value is bilinear between the centres of pixels, constant from the
/// outermost centres to the edge, and 0 beyond the edge.
///
/// The picture appears upright and unmirrored to a viewer in front of the surface with X to the
/// right and Y up: the first pixel is at the top left.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Picture {
    /// Width along X and height along Y, in metres.
    pub size: [f64; 2],
    /// Pixels, numbers from 0 to 1.
    #[serde(serialize_with = "shared")]
    pub pixels: Arc<Raster>,
}

fn shared<S: Serializer>(pixels: &Arc<Raster>, serializer: S) -> Result<S::Ok, S::Error> {
    pixels.as_ref().serialize(serializer)
}

impl Picture {
    /// The value at (s, t).
    #[inline]
    #[must_use]
    pub fn value(&self, s: f64, t: f64) -> f64 {
        let [across, down] = [0.5 + s / self.size[0], 0.5 - t / self.size[1]];
        if !(0.0..=1.0).contains(&across) || !(0.0..=1.0).contains(&down) {
            return 0.0;
        }
        let [w, h] = [self.pixels.width() as f64, self.pixels.height() as f64];
        self.pixels.value(w * across, h * down, false)
    }
}

impl Pattern {
    /// The value at (s, t).
    #[inline]
    #[must_use]
    pub fn value(&self, s: f64, t: f64) -> f64 {
        match self {
            Self::Cosine(grating) => grating.transmittance(s, t),
            Self::Checkerboard { period } => {
                let is_low = |x: f64| (x / period).rem_euclid(1.0) < 0.5;
                if is_low(s) == is_low(t) { 1.0 } else { 0.0 }
            }
            Self::Picture(picture) => picture.value(s, t),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_the_right_way_round() {
        let pixels = Raster::new(2, 2, vec![0.1, 0.2, 0.3, 0.4]).unwrap();
        let size = [0.4, 0.2];
        let pattern = Pattern::Picture(Picture {
            size,
            pixels: Arc::new(pixels),
        });
        for (s, t, expected) in [
            (-0.19, 0.09, 0.1),
            (0.1, 0.05, 0.2),
            (-0.1, -0.05, 0.3),
            (0.2, -0.1, 0.4),
            (0.0, 0.0, 0.25),
            (0.21, 0.0, 0.0),
            (0.0, -0.11, 0.0),
        ] {
            // The limit is the rounding error.
            assert!((pattern.value(s, t) - expected).abs() < 1e-15, "({s}, {t})");
        }
    }
}
