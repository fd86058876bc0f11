//! What theory knows about each kind of light: the flux along a ray, random parts of the light, its
//! closed form between parallel planes, and its description.

use crate::sky::SkyDensity;
use crate::words::formula;
use etendue_field::{Disc, EmittedRays, Environment, Image, Light, Rectangle, Shape, tidy};
use glam::DVec3;
use std::f64::consts::TAU;
use std::sync::Arc;

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

/// A light whose field has closed forms between parallel planes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ParallelEmitter {
    /// The shape of the light; `None` for a point on the central ray.
    pub(crate) shape: Option<Shape>,
    /// Radiance or intensity along the central ray.
    pub(crate) brightness: f64,
    /// The power p of the factor (1 + u² + v²)^p on radiance. For a spot's cosⁿθ, p = −n/2. For a
    /// point light, p = ½, because the distance from the light to (x, y) is D √(1 + u² + v²).
    pub(crate) power: f64,
}

/// The light as a factor of closed forms between parallel planes, or the reason why it has no closed
/// form, in words.
pub(crate) fn closed_form(light: &Light) -> Result<ParallelEmitter, &'static str> {
    let (brightness, power) = match light {
        Light::Area {
            radiance, exponent, ..
        } => (*radiance, -0.5 * exponent),
        Light::Point { intensity } => (*intensity, 0.5),
        Light::Projector { .. } | Light::Beam { .. } => {
            return Err("the light of a picture, unless all surfaces of the path are smooth");
        }
        Light::Environment { .. } => return Err("light of an environment"),
        Light::Rays { .. } => return Err("light of a ray file beyond the first surface"),
    };
    Ok(ParallelEmitter {
        shape: light.shape().copied(),
        brightness,
        power,
    })
}

/// The reason why the theory of parallel planes has no closed form for a light, in words; `None` if
/// it has one.
#[must_use]
pub fn without_closed_form(light: &Light) -> Option<&'static str> {
    closed_form(light).err()
}

/// A light in words.
pub(crate) fn in_words(light: &Light) -> String {
    match light {
        Light::Area {
            shape,
            radiance,
            exponent,
        } => {
            let (kind, lobe) = if *exponent == 0.0 {
                ("Lambertian ", String::new())
            } else {
                ("", format!(" cosⁿθ, n = {exponent}"))
            };
            let shape = shape_in_words(shape);
            format!("{kind}{shape}, radiance {radiance} W m⁻² sr⁻¹{lobe}")
        }
        Light::Point { intensity } => format!("point, intensity {intensity} W sr⁻¹"),
        Light::Projector { intensity, image } => {
            let picture = picture(image, ["u", "v"]);
            format!("projector, intensity {intensity} W sr⁻¹ × {picture}")
        }
        Light::Beam { irradiance, image } => {
            let picture = picture(image, ["x", "y"]);
            format!("beam, irradiance {irradiance} W m⁻² × {picture}")
        }
        Light::Environment { .. } => "environment".to_owned(),
        Light::Rays { rays } => {
            let (count, flux) = (rays.rays().len(), tidy(rays.flux()));
            format!("{count} rays of a file, {flux} W")
        }
    }
}

fn picture(image: &Image, [a, b]: [&str; 2]) -> String {
    let [w, h] = image.width;
    let envelope = format!("exp(−π({a}²/{w}² + {b}²/{h}²))");
    match image.grating {
        Some(grating) => format!("{envelope} {}", formula(&grating, [a, b])),
        None => envelope,
    }
}

fn shape_in_words(shape: &Shape) -> String {
    match shape {
        Shape::Rectangle(Rectangle {
            size: [width, height],
            ..
        }) => format!("rectangle {width} x {height} m"),
        Shape::Disc(Disc { radius, .. }) => format!("disc of radius {radius} m"),
    }
}

/// A part of a light.
#[derive(Clone, Copy, Debug)]
pub(crate) enum LightPart {
    /// The complete light, if its light arrives at a point from a single direction.
    Whole,
    /// A point of an area light. Densities of points on an area light are per square metre.
    Point([f64; 2]),
    /// A direction of an environment. Densities of directions of an environment are per steradian.
    Sky {
        /// Slopes of rays from the environment, in the direction of light.
        slopes: [f64; 2],
        /// The cosine of the angle between these rays and the central ray.
        cosine: f64,
        /// Radiance of the environment in this direction, W m⁻² sr⁻¹.
        radiance: f64,
    },
}

/// Random parts of a light.
#[derive(Clone, Debug)]
pub(crate) enum LightParts<'a> {
    /// A light without extent, which is its only part.
    Whole,
    /// Points of a shape.
    Points(&'a Shape),
    /// Directions of an environment.
    Sky(&'a Environment, Arc<SkyDensity<'a>>),
}

impl<'a> LightParts<'a> {
    /// Returns `None` if no part of the light emits light. Directions of an environment are drawn
    /// for a surface with this normal, which is given in the frame at the light.
    pub(crate) fn new(light: &'a Light, normal: DVec3) -> Option<Self> {
        Some(match light.rays() {
            EmittedRays::OfShape(shape) => Self::Points(shape),
            EmittedRays::OfSky(environment) => {
                Self::Sky(environment, Arc::new(SkyDensity::new(environment, normal)?))
            }
            EmittedRays::OfPoint(_) | EmittedRays::Parallel(_) | EmittedRays::Listed(_) => {
                Self::Whole
            }
        })
    }

    /// The parts of a changed light, in the same environment.
    pub(crate) fn of<'b>(&'b self, light: &'b Light) -> LightParts<'b> {
        light
            .shape()
            .map_or_else(|| self.clone(), LightParts::Points)
    }

    /// The part for a point of the unit square, and its density; `None` if its light does not
    /// leave the light's plane towards positive z.
    pub(crate) fn draw(&self, at: [f64; 2]) -> Option<(LightPart, f64)> {
        match self {
            Self::Whole => Some((LightPart::Whole, 1.0)),
            Self::Points(shape) => {
                Some((LightPart::Point(point_of(shape, at)), 1.0 / shape.area()))
            }
            Self::Sky(environment, sky) => {
                let from = sky.draw(at);
                of_sky(
                    environment,
                    sky,
                    -environment.frame.vector_to_world(from),
                    from,
                )
            }
        }
    }

    /// The part that is seen from a point in the direction `towards`, and the density with which
    /// [`Self::draw`] draws this part; `None` if this direction misses the light.
    pub(crate) fn seen(&self, point: DVec3, towards: DVec3) -> Option<(LightPart, f64)> {
        match self {
            Self::Whole => None,
            Self::Points(shape) => {
                let [u, v] = forward(-towards)?;
                let DVec3 { x, y, z } = point;
                let [a, b] = [x - z * u, y - z * v];
                let meets = shape.contains(a, b);
                meets.then(|| (LightPart::Point([a, b]), 1.0 / shape.area()))
            }
            Self::Sky(environment, sky) => {
                of_sky(environment, sky, -towards, environment.origin_of(-towards))
            }
        }
    }
}

/// The part of an environment from which light travels along `along`, and its density; `from` is
/// the direction from which this light comes, in the axes of the map.
fn of_sky(
    environment: &Environment,
    sky: &SkyDensity<'_>,
    along: DVec3,
    from: DVec3,
) -> Option<(LightPart, f64)> {
    let slopes = forward(along)?;
    let radiance = environment.map.radiance(from);
    let density = sky.density(from, radiance);
    let cosine = along.z;
    Some((
        LightPart::Sky {
            slopes,
            cosine,
            radiance,
        },
        density,
    ))
}

/// The slopes of light along a direction, or `None` if the direction does not point
/// towards positive z.
fn forward(along: DVec3) -> Option<[f64; 2]> {
    (along.z > 0.0).then(|| [along.x / along.z, along.y / along.z])
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
