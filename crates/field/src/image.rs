//! The smooth picture of a projector or a beam.

use crate::Grating;
use serde::Serialize;

/// A smooth picture over a plane: exp(−π (a²/w₁² + b²/w₂²)), times a cosine grating if there is one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Image {
    /// Widths w₁ and w₂, in the unit of the coordinates.
    pub width: [f64; 2],
    /// The grating, if there is one.
    pub grating: Option<Grating>,
}

/// The distance from the centre, in widths, beyond which a picture is dark. Its envelope is
/// exp(−π 3.6²) = 2·10⁻¹⁸ there.
const REACH: f64 = 3.6;

impl Image {
    /// The picture at (a, b). The picture is 0 where |a| or |b| exceeds its reach.
    #[inline]
    #[must_use]
    pub fn value(&self, a: f64, b: f64) -> f64 {
        let [p, q] = [a / self.width[0], b / self.width[1]];
        if p.abs() > REACH || q.abs() > REACH {
            return 0.0;
        }
        let envelope = libm::exp(-std::f64::consts::PI * (p * p + q * q));
        let grating = self.grating.map_or(1.0, |g| g.transmittance(a, b));
        envelope * grating
    }

    /// The largest |a| and |b| at which the picture is not dark: 3.6 widths.
    #[must_use]
    pub fn reach(&self) -> [f64; 2] {
        self.width.map(|width| REACH * width)
    }

    /// The integral of the envelope, w₁ w₂.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.width[0] * self.width[1]
    }
}
