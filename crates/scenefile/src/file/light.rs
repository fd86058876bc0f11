//! Lights, as written.

use super::allowed::{
    cycles, direction, factor, intensity, length, modulation, phase, place, radiance, sides, told,
    within,
};
use super::{AxisName, along_y, along_z, one};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The light. The central ray leaves its centre.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Light", deny_unknown_fields)]
#[schemars(transform = told("a light", "Rectangle(center: (0, 0, 0), size: (0.2, 0.2))"))]
pub enum LightFile {
    /// A Lambertian rectangle orthogonal to the central ray, edges along X and Y, dark on its back.
    Rectangle {
        /// Centre, world coordinates.
        #[schemars(transform = place)]
        center: [f64; 3],
        /// Side lengths along X and Y.
        #[schemars(transform = sides)]
        size: [f64; 2],
        /// Radiance, W m⁻² sr⁻¹.
        #[serde(default = "one")]
        #[schemars(transform = radiance)]
        radiance: f64,
    },
    /// A Lambertian disc orthogonal to the central ray, dark on its back.
    Disc {
        /// Centre, world coordinates.
        #[schemars(transform = place)]
        center: [f64; 3],
        /// Radius.
        #[schemars(transform = length)]
        radius: f64,
        /// Radiance, W m⁻² sr⁻¹.
        #[serde(default = "one")]
        #[schemars(transform = radiance)]
        radiance: f64,
    },
    /// A point that shines alike in all directions.
    Point {
        /// Where it is, world coordinates.
        #[schemars(transform = place)]
        center: [f64; 3],
        /// Intensity, W sr⁻¹.
        #[serde(default = "one")]
        #[schemars(transform = intensity)]
        intensity: f64,
    },
    /// A flat bulb whose radiance falls off as cosⁿθ from the central ray.
    Spot {
        /// Centre, world coordinates.
        #[schemars(transform = place)]
        center: [f64; 3],
        /// Its shape.
        bulb: BulbFile,
        /// Radiance along the central ray, W m⁻² sr⁻¹.
        #[serde(default = "one")]
        #[schemars(transform = radiance)]
        radiance: f64,
        /// The exponent n.
        #[schemars(transform = told("an exponent", "20"), transform = within(0.0, 1e4))]
        exponent: f64,
    },
    /// A slide projector: a point whose intensity is a picture over slopes.
    Projector {
        /// Where it is, world coordinates.
        #[schemars(transform = place)]
        center: [f64; 3],
        /// Intensity where the picture is 1, W sr⁻¹.
        #[serde(default = "one")]
        #[schemars(transform = intensity)]
        intensity: f64,
        /// The picture, over slopes along X and along Y.
        image: ImageFile,
    },
    /// A collimated beam along the central ray whose irradiance is a picture.
    Beam {
        /// Where the central ray begins, world coordinates.
        #[schemars(transform = place)]
        center: [f64; 3],
        /// Irradiance where the picture is 1, W m⁻².
        #[serde(default = "one")]
        #[schemars(transform = told("an irradiance, W m⁻²", "1"))]
        irradiance: f64,
        /// The picture, in metres along X and along Y.
        image: ImageFile,
    },
    /// Light from far away; that alone shines which comes from before the plane across `path.direction` at the centre.
    Environment {
        /// Where the central ray begins, world coordinates.
        #[schemars(transform = place)]
        center: [f64; 3],
        /// Direction of the map's top, any length.
        #[serde(default = "along_y")]
        #[schemars(transform = direction("(0, 1, 0)"))]
        up: [f64; 3],
        /// Direction of the middle of the map, any length: its part orthogonal to `up` is used.
        #[serde(default = "along_z")]
        #[schemars(transform = direction("(0, 0, 1)"))]
        front: [f64; 3],
        /// Factor on the map.
        #[serde(default = "one")]
        #[schemars(transform = factor)]
        scale: f64,
        /// How much comes from where.
        map: EnvironmentFile,
    },
    /// The rays of a file, as they go through the plane across `path.direction` at the centre; those that go back from it are left out.
    Rays {
        /// Where the origin of the file is, and where the central ray begins, world coordinates.
        #[schemars(transform = place)]
        center: [f64; 3],
        /// IES TM-25, MCPL or NPY; the path is relative to the scene file, and stays inside its folder.
        #[schemars(transform = told("a ray file in quotes", r#""led.tm25ray""#))]
        file: String,
        /// Direction of the file's Z axis, any length. Left out: `path.direction`.
        #[serde(default)]
        #[schemars(transform = direction("(0, 0, 1)"))]
        front: Option<[f64; 3]>,
        /// Direction of the file's Y axis, any length: its part orthogonal to `front` is used. Left out: that of the central ray's frame.
        #[serde(default)]
        #[schemars(transform = direction("(0, 1, 0)"))]
        up: Option<[f64; 3]>,
        /// Flux of all rays of the file, W. Left out: what the file says; it must say so in W, or in lm with its total in W and lm.
        #[serde(default)]
        #[schemars(transform = told("a flux in watts", "0.5"))]
        flux: Option<f64>,
    },
}

impl LightFile {
    /// Where the central ray leaves it, world coordinates.
    #[must_use]
    pub fn center(&self) -> [f64; 3] {
        match self {
            Self::Rectangle { center, .. }
            | Self::Disc { center, .. }
            | Self::Point { center, .. }
            | Self::Spot { center, .. }
            | Self::Projector { center, .. }
            | Self::Beam { center, .. }
            | Self::Environment { center, .. }
            | Self::Rays { center, .. } => *center,
        }
    }
}

/// Radiance by the direction light comes from; in coordinates whose second axis is `up` and whose third is `front`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Environment")]
#[schemars(transform = told("what comes from where", "Lobes([(from: (0, 0, -1), width: 0.3)])"))]
pub enum EnvironmentFile {
    /// A sum of lobes.
    Lobes(Vec<SphericalGaussianFile>),
    /// An OpenEXR picture over latitude and longitude, W m⁻² sr⁻¹; the path is relative to the scene file, and stays inside its folder.
    File(String),
}

/// A lobe of light, radiance · exp((cos γ − 1)/width²), γ being the angle to `from`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "LightLobe", deny_unknown_fields)]
#[schemars(transform = told("a lobe", "(from: (0, 0, -1), width: 0.3)"))]
pub struct SphericalGaussianFile {
    /// The direction most of it comes from, any length.
    #[schemars(transform = direction("(0, 0, -1)"))]
    pub from: [f64; 3],
    /// Its width, radians.
    #[schemars(transform = told("an angle in radians", "0.3"), transform = within(1e-4, 1e3))]
    pub width: f64,
    /// Radiance from that direction, W m⁻² sr⁻¹.
    #[serde(default = "one")]
    #[schemars(transform = radiance)]
    pub radiance: f64,
}

/// A smooth picture: exp(−π (a²/w₁² + b²/w₂²)), times a grating ½ (1 + m cos(2π f t + p)) if it has one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Image", deny_unknown_fields)]
#[schemars(transform = told("a picture", "(width: (0.2, 0.2))"))]
pub struct ImageFile {
    /// w₁ and w₂ along X and along Y.
    #[schemars(transform = told("two numbers, along X and along Y", "(0.2, 0.2)"))]
    pub width: [f64; 2],
    /// Its grating.
    #[serde(default)]
    pub grating: Option<GratingFile>,
}

/// The grating of a picture or a pattern.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Grating", deny_unknown_fields)]
#[schemars(transform = told("a grating", "(axis: X, frequency: 5)"))]
pub struct GratingFile {
    /// The axis along which it varies.
    pub axis: AxisName,
    /// f, cycles per unit of the picture, or per metre of a surface.
    #[schemars(transform = cycles)]
    pub frequency: f64,
    /// m.
    #[serde(default = "one")]
    #[schemars(transform = modulation)]
    pub modulation: f64,
    /// p, radians.
    #[serde(default)]
    #[schemars(transform = phase)]
    pub phase: f64,
}

/// The bulb of a spot, orthogonal to the central ray.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Bulb")]
#[schemars(transform = told("a bulb", "Square(0.1)"))]
pub enum BulbFile {
    /// A square with this side, edges along X and Y.
    Square(f64),
    /// A disc with this radius.
    Disc(f64),
}
