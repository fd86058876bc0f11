//! The light of a scene file.

use super::allowed::{
    cycles, direction, factor, intensity, length, modulation, phase, place, radiance, sides, told,
    within,
};
use super::{AxisName, ColorFile, along_y, along_z, one, white};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The light; the central ray starts at its centre.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Light", deny_unknown_fields)]
#[schemars(transform = told("a light", "Rectangle(center: (0, 0, 0), size: (0.2, 0.2))"))]
pub enum LightFile {
    /// A Lambertian rectangle orthogonal to the central ray, with edges along X and Y and a dark back.
    Rectangle {
        /// Centre, in world coordinates.
        #[schemars(transform = place)]
        center: [f64; 3],
        /// Side lengths along X and Y.
        #[schemars(transform = sides)]
        size: [f64; 2],
        /// Radiance, in W m⁻² sr⁻¹.
        #[serde(default = "white")]
        #[schemars(transform = radiance)]
        radiance: ColorFile,
    },
    /// A Lambertian disc orthogonal to the central ray, with a dark back.
    Disc {
        /// Centre, in world coordinates.
        #[schemars(transform = place)]
        center: [f64; 3],
        /// Radius.
        #[schemars(transform = length)]
        radius: f64,
        /// Radiance, in W m⁻² sr⁻¹.
        #[serde(default = "white")]
        #[schemars(transform = radiance)]
        radiance: ColorFile,
    },
    /// A point that emits uniformly in all directions ahead, along `path.direction`. No light goes back.
    Point {
        /// Position, in world coordinates.
        #[schemars(transform = place)]
        center: [f64; 3],
        /// Intensity, in W sr⁻¹.
        #[serde(default = "white")]
        #[schemars(transform = intensity)]
        intensity: ColorFile,
    },
    /// A flat bulb whose radiance falls off as cosⁿθ, where θ is the angle to the central
    /// ray.
    Spot {
        /// Centre, in world coordinates.
        #[schemars(transform = place)]
        center: [f64; 3],
        /// Shape of the bulb.
        bulb: BulbFile,
        /// Radiance along the central ray, in W m⁻² sr⁻¹.
        #[serde(default = "white")]
        #[schemars(transform = radiance)]
        radiance: ColorFile,
        /// The exponent n.
        #[schemars(transform = told("an exponent", "20"), transform = within(0.0, 1e4))]
        exponent: f64,
    },
    /// A slide projector: a point whose intensity is a picture over slopes.
    Projector {
        /// Position, in world coordinates.
        #[schemars(transform = place)]
        center: [f64; 3],
        /// Intensity, in W sr⁻¹, where the picture has the value 1.
        #[serde(default = "white")]
        #[schemars(transform = intensity)]
        intensity: ColorFile,
        /// The picture, over slopes along X and along Y.
        image: ImageFile,
    },
    /// A collimated beam along the central ray whose irradiance is a picture.
    Beam {
        /// Start of the central ray, in world coordinates.
        #[schemars(transform = place)]
        center: [f64; 3],
        /// Irradiance, in W m⁻², where the picture has the value 1.
        #[serde(default = "white")]
        #[schemars(transform = told("an irradiance, in W m⁻², or three for red, green and blue", "1"))]
        irradiance: ColorFile,
        /// The picture, in metres along X and along Y.
        image: ImageFile,
    },
    /// Light from an environment. It starts in a plane that contains the centre and is orthogonal to
    /// `path.direction`, and it only travels forward from there.
    Environment {
        /// Start of the central ray, in world coordinates.
        #[schemars(transform = place)]
        center: [f64; 3],
        /// Direction, of any length, of the top of the map.
        #[serde(default = "along_y")]
        #[schemars(transform = direction("(0, 1, 0)"))]
        up: [f64; 3],
        /// Direction, of any length, of the middle of the map; only the part orthogonal to `up` is
        /// used.
        #[serde(default = "along_z")]
        #[schemars(transform = direction("(0, 0, 1)"))]
        front: [f64; 3],
        /// Scale factor of the map's radiance.
        #[serde(default = "one")]
        #[schemars(transform = factor)]
        scale: f64,
        /// Radiance by direction.
        map: EnvironmentFile,
    },
    /// The rays of a file. They start where they cross the plane through the centre that is
    /// perpendicular to `path.direction`; rays that go backwards are omitted.
    Rays {
        /// Position of the file's origin and start of the central ray, in world coordinates.
        #[schemars(transform = place)]
        center: [f64; 3],
        /// IES TM-25, MCPL or NPY file; the path is relative to the scene file, and must stay
        /// inside its folder.
        #[schemars(transform = told("a ray file in quotes", r#""led.tm25ray""#))]
        file: String,
        /// Direction, of any length, of the file's Z axis; by default, `path.direction`.
        #[serde(default)]
        #[schemars(transform = direction("(0, 0, 1)"))]
        front: Option<[f64; 3]>,
        /// Direction, of any length, of the file's Y axis; only the part orthogonal to `front` is
        /// used. By default, the Y axis of the central ray's frame.
        #[serde(default)]
        #[schemars(transform = direction("(0, 1, 0)"))]
        up: Option<[f64; 3]>,
        /// Flux of all rays of the file, in W. By default, the flux that the file states. This flux
        /// must be in W, or in lm if the file states the total flux in both W and lm.
        #[serde(default)]
        #[schemars(transform = told("a flux in watts", "0.5"))]
        flux: Option<f64>,
    },
}

impl LightFile {
    /// The point at which the central ray leaves the light, in world coordinates.
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

/// Radiance by the direction from which light comes, in coordinates whose second axis is `up` and
/// whose third is `front`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Environment")]
#[schemars(transform = told("the light from each direction", "Lobes([(from: (0, 0, -1), width: 0.3)])"))]
pub enum EnvironmentFile {
    /// A sum of lobes.
    Lobes(Vec<SphericalGaussianFile>),
    /// An OpenEXR picture of the radiance, in W m⁻² sr⁻¹, over latitude and longitude; the path is relative to the
    /// scene file, and must stay inside its folder.
    File(String),
}

/// A lobe of light, radiance · exp((cos γ − 1)/width²), where γ is the angle to `from`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "LightLobe", deny_unknown_fields)]
#[schemars(transform = told("a lobe", "(from: (0, 0, -1), width: 0.3)"))]
pub struct SphericalGaussianFile {
    /// Direction, of any length, from which most of the light comes.
    #[schemars(transform = direction("(0, 0, -1)"))]
    pub from: [f64; 3],
    /// Width of the lobe, in radians.
    #[schemars(transform = told("an angle in radians", "0.3"), transform = within(1e-4, 1e3))]
    pub width: f64,
    /// Radiance from the direction `from`, in W m⁻² sr⁻¹.
    #[serde(default = "white")]
    #[schemars(transform = radiance)]
    pub radiance: ColorFile,
}

/// A smooth picture: exp(−π (a²/w₁² + b²/w₂²)), optionally times a grating ½ (1 + m cos(2π f t +
/// p)). It is 0 beyond 3.6 widths, where the exponential is 2·10⁻¹⁸.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Image", deny_unknown_fields)]
#[schemars(transform = told("a picture", "(width: (0.2, 0.2))"))]
pub struct ImageFile {
    /// Widths w₁ and w₂ along X and along Y.
    #[schemars(transform = told("two numbers, along X and along Y", "(0.2, 0.2)"))]
    pub width: [f64; 2],
    /// Grating of the picture.
    #[serde(default)]
    pub grating: Option<GratingFile>,
}

/// The grating of a picture or a pattern.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Grating", deny_unknown_fields)]
#[schemars(transform = told("a grating", "(axis: X, frequency: 5)"))]
pub struct GratingFile {
    /// The axis along which the grating varies.
    pub axis: AxisName,
    /// Frequency f, in cycles per unit of the picture, or per metre of a surface.
    #[schemars(transform = cycles)]
    pub frequency: f64,
    /// Modulation m.
    #[serde(default = "one")]
    #[schemars(transform = modulation)]
    pub modulation: f64,
    /// Phase p, in radians.
    #[serde(default)]
    #[schemars(transform = phase)]
    pub phase: f64,
}

/// The flat bulb of a spot. The bulb is orthogonal to the central ray.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Bulb")]
#[schemars(transform = told("a bulb", "Square(0.1)"))]
pub enum BulbFile {
    /// A square with this side length and edges along X and Y.
    Square(f64),
    /// A disc with this radius.
    Disc(f64),
}
