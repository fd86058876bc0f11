//! What varies over a surface.

use crate::{Grating, Raster};
use serde::{Serialize, Serializer};
use std::sync::Arc;

/// A number from 0 to 1 at each place of a surface.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Pattern {
    /// ½ (1 + m cos(2π f t + p)) along an axis.
    Cosine(Grating),
    /// 1 and 0 by turns on squares with edges along both axes, 1 on the first beyond the vertex along both.
    Checkerboard {
        /// Two sides of a square, in metres.
        period: f64,
    },
    /// A picture around the vertex.
    Picture(Picture),
}

/// A picture on a surface: bilinear between the centres of pixels, as at the nearest centre from there to the edge, 0 beyond its edge.
///
/// Seen from where the surface faces with X to the right and Y up, it is the right way round: the first pixel is at the top left.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Picture {
    /// Its width along X and its height along Y, in metres.
    pub size: [f64; 2],
    /// Numbers from 0 to 1.
    #[serde(serialize_with = "shared")]
    pub pixels: Arc<Raster>,
}

fn shared<S: Serializer>(pixels: &Arc<Raster>, serializer: S) -> Result<S::Ok, S::Error> {
    pixels.as_ref().serialize(serializer)
}

impl Picture {
    /// Its value at (s, t).
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
    /// Its value at (s, t).
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
            // Rounding.
            assert!((pattern.value(s, t) - expected).abs() < 1e-15, "({s}, {t})");
        }
    }
}
