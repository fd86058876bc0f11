//! Draws rays in proportion to the emission of a light, regardless of planes.

use crate::sampling::point;
use etendue_field::{Image, RayLight, Shape, TwoPlane, power};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// The distribution from which plain emission draws rays.
#[derive(Debug)]
pub(super) enum Plain {
    /// Points of an area light of radiance L cosⁿθ, uniform over the light, and directions in
    /// proportion to cosⁿ⁺¹θ. The fields are the shape of the light and the exponent n.
    Area(Shape, f64),
    /// Directions of a point light, uniform in solid angle over the forward hemisphere.
    Point,
    /// Slopes of a projector, drawn by the Gaussian envelope of the projector's picture.
    Slopes(Image),
    /// Positions on a beam, drawn by the Gaussian envelope of the beam's picture.
    Positions(Image),
    /// Rays of a file, each drawn in proportion to its flux.
    Rays(Arc<RayLight>),
}

/// The number of different values that a 32-bit word can have.
const WORD: f64 = 4_294_967_296.0;

impl Plain {
    /// A ray drawn with four random numbers in (0, 1).
    #[inline(never)]
    pub(super) fn sample(&self, r: [f64; 4]) -> TwoPlane {
        let (sin, cos) = libm::sincos(TAU * r[3]);
        // Returns two normal deviates (Box and Muller 1958), scaled to a point that follows the
        // picture's envelope.
        let normal = |image: &Image| {
            let radius = (-libm::log(r[2]) / PI).sqrt();
            [image.width[0] * radius * cos, image.width[1] * radius * sin]
        };
        let [[x, y], [u, v]] = match self {
            Self::Area(shape, exponent) => {
                let squared = power(1.0 - r[2], 2.0 / (exponent + 2.0)); // cos²θ
                let slope = ((1.0 - squared) / squared).sqrt();
                [point(shape, [r[0], r[1]]), [slope * cos, slope * sin]]
            }
            Self::Point => {
                let height = 1.0 - r[2];
                let slope = (1.0 - height * height).sqrt() / height;
                [[0.0; 2], [slope * cos, slope * sin]]
            }
            Self::Slopes(image) => [[0.0; 2], normal(image)],
            Self::Positions(image) => [normal(image), [0.0; 2]],
            // The second random number adds digits to the first, because a file may have as many
            // rays as a 32-bit word has values.
            Self::Rays(rays) => return rays.at_share(r[0] + (r[1] - 0.5) / WORD).ray,
        };
        TwoPlane { x, y, u, v }
    }

    /// The density of [`Self::sample`]. The density is per du dv for a point light or a
    /// projector, per dx dy for a beam, and per dx dy du dv for an area light. A ray of a
    /// file is drawn with a probability equal to its share of the flux, and then represents the
    /// total flux. Therefore its density is 1.
    #[inline]
    pub(super) fn density(&self, ray: &TwoPlane) -> f64 {
        let secant_squared = ray.secant_squared();
        match self {
            // cos θ dω = du dv / (1 + u² + v²)², and ∫ cosⁿθ cos θ dω = 2π/(n + 2).
            Self::Area(shape, exponent) => {
                let lobe = (exponent + 2.0) / TAU * power(secant_squared, -2.0 - 0.5 * exponent);
                lobe / shape.area()
            }
            Self::Point => 1.0 / (TAU * secant_squared * secant_squared.sqrt()),
            Self::Slopes(image) => envelope(image, ray.u, ray.v),
            Self::Positions(image) => envelope(image, ray.x, ray.y),
            Self::Rays(_) => 1.0,
        }
    }
}

/// The envelope of a picture at (a, b), normalised to an integral of 1.
fn envelope(image: &Image, a: f64, b: f64) -> f64 {
    let grating = None;
    Image { grating, ..*image }.value(a, b) / image.area()
}
