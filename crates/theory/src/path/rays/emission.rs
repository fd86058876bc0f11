//! The emission of a light.

use crate::nets::LinearDensity;
use crate::path::{PathMask, PathSystem};
use etendue_field::{Light, Shape};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// The ray coordinates that parametrise a light's emission. The two inner coordinates are two of x,
/// y, u and v. For a light with extent, the other two coordinates are also needed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EmissionMeasure {
    /// Indices, among x, y, u and v, of the two inner coordinates.
    pub(super) inner: [usize; 2],
    /// The largest absolute value of each inner coordinate at which rays are searched for.
    pub(super) reach: [f64; 2],
    /// Number of cycles of the light's picture per unit of each inner coordinate.
    pub(super) cycles: [f64; 2],
}

/// The largest slope for which rays are sought, if the light has no picture.
const STEEPEST: f64 = 30.0;

impl EmissionMeasure {
    /// The indices, among x, y, u and v, of the two coordinates that are not inner
    /// coordinates.
    pub(super) fn outer(&self) -> [usize; 2] {
        self.inner.map(|inner| (inner + 2) % 4)
    }
}

impl PathSystem {
    pub(super) fn emission(&self) -> EmissionMeasure {
        let image = self.light.image();
        let inner = if self.light.is_distant() {
            [0, 1]
        } else {
            [2, 3]
        };
        let mut cycles = [0.0; 2];
        if let Some(image) = image {
            // Above the frequency 2/w, the transform of a Gaussian of width w is below 10⁻⁵.
            cycles = image.width.map(|w| 2.0 / w);
            if let Some(grating) = image.grating {
                cycles[grating.axis] += grating.frequency.abs();
            }
        }
        for PathMask { distance, mask, .. } in &self.masks {
            if let Some(grating) = mask.grating() {
                let per_unit = if inner[0] == 0 { 1.0 } else { distance.abs() };
                cycles[grating.axis] += grating.frequency.abs() * per_unit;
            }
        }
        EmissionMeasure {
            inner,
            reach: image.map_or([STEEPEST; 2], etendue_field::Image::reach),
            cycles,
        }
    }

    /// The densities of the two inner coordinates in proportion to the light's picture, or
    /// `None` if the light has no picture.
    pub(super) fn picture_densities(&self) -> Option<[LinearDensity; 2]> {
        let image = self.light.image()?;
        let along = |axis: usize| {
            let width = image.width[axis];
            let grating = image.grating.filter(|g| g.axis == axis);
            let reach = image.reach()[axis];
            LinearDensity::new([-reach, reach], |t| {
                let [a, b] = if axis == 0 { [t, 0.0] } else { [0.0, t] };
                let passes = grating.map_or(1.0, |g| g.transmittance(a, b));
                // The constant 0.1 ensures that no line of a grating is missed between the
                // tabulated values of the density.
                libm::exp(-PI * (t / width).powi(2)) * (passes + 0.1)
            })
        };
        Some([along(0)?, along(1)?])
    }
}

/// The flux, per unit of the emission's coordinates, of the ray (x, y, u, v) that leaves a
/// light:
///
/// | light | flux |
/// |---|---|
/// | projector | I · image(u, v) · (1 + u² + v²)^(−3/2) du dv |
/// | point | the same with a white image |
/// | beam | E · image(x, y) dx dy |
/// | area light | L₀ (1 + u² + v²)^(−2 − n/2) dx dy du dv |
/// | environment | L(u, v) (1 + u² + v²)⁻² dx dy du dv |
pub(crate) fn emitted(light: &Light, ray: [f64; 4]) -> f64 {
    let [x, y, u, v] = ray;
    let cosine = 1.0 / (1.0 + u * u + v * v).sqrt();
    match light {
        Light::Projector { intensity, image } => intensity * image.value(u, v) * cosine.powi(3),
        Light::Point { intensity } => intensity * cosine.powi(3),
        Light::Beam { irradiance, image } => irradiance * image.value(x, y),
        Light::Area {
            radiance, exponent, ..
        } => radiance * cosine.powi(4) * libm::pow(cosine, *exponent),
        Light::Environment { environment } => {
            environment.radiance(DVec3::new(u, v, 1.0)) * cosine.powi(4)
        }
        Light::Rays { .. } => panic!("rays of a file are summed, not drawn"),
    }
}

/// Maps a point (a, b) of the unit square to a point of a shape, so that uniform points of the
/// square are uniform on the shape.
pub(crate) fn point_of(shape: &Shape, [a, b]: [f64; 2]) -> [f64; 2] {
    match shape {
        Shape::Rectangle(rectangle) => {
            let [x, y] = rectangle.center;
            let [w, h] = rectangle.size;
            [x + w * (a - 0.5), y + h * (b - 0.5)]
        }
        Shape::Disc(disc) => {
            let [x, y] = disc.center;
            let (sin, cos) = libm::sincos(TAU * b);
            let r = disc.radius * a.sqrt();
            [x + r * cos, y + r * sin]
        }
    }
}
