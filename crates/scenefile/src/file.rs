//! Scene files as they are written.

mod allowed;
mod blockers;
mod color;
mod format;
mod light;
mod surface;

pub use blockers::{BlockersFile, HalfName, HoleFile, ShapeFile};
pub use color::{Color, ColorFile};
pub use format::SceneFormat;
pub use light::{
    BulbFile, EnvironmentFile, GratingFile, ImageFile, LightFile, SphericalGaussianFile,
};
pub use surface::{
    BrdfFile, EventFile, FormFile, FresnelFile, LobeFile, MeshSource, PatternFile, SurfaceFile,
    TermFile,
};

pub(crate) use allowed::{is_number, positive};

use crate::whole_number::whole;
use allowed::{depends, direction, profile_of_place, profile_of_slope, seed, since, told, within};
use etendue_field::{Orientation, Profile, Quantity};
use schemars::JsonSchema;
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;

/// A scene file as written. Lengths are in metres; slopes are tangents of angles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Scene", deny_unknown_fields)]
pub struct SceneFile {
    /// The number of the format of this file. It stands first, so that a version that does not
    /// know the format says so.
    #[serde(default, skip_serializing)]
    #[schemars(with = "u32", transform = told("a format that this version reads", "1"), transform = within(1.0, 1.0))]
    pub format: SceneFormat,
    /// A description of the scene for the reader.
    #[serde(default)]
    #[schemars(transform = told("a text in quotes", r#""my first scene""#))]
    pub description: String,
    /// The light source.
    pub light: LightFile,
    /// Further lights. Their light adds to that of `light`, and all lights shine along the central
    /// ray. Only a `Rectangle`, a `Disc` or a `Spot` may stand beside the central ray.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(transform = told("a list of lights", "[Disc(center: (0.5, 0, 0), radius: 0.1)]"))]
    pub other_lights: Vec<LightFile>,
    /// The blockers.
    #[serde(default)]
    #[schemars(transform = told("a list of blockers", r#"[Grating(name: "bars", center: (0, 0, 1), axis: X, frequency: 5)]"#))]
    pub blockers: Vec<BlockersFile>,
    /// The surfaces.
    #[serde(default)]
    #[schemars(transform = told("a list of surfaces", r#"[Rectangle(name: "floor", center: (0, 0, 2), size: (6, 6))]"#))]
    pub surfaces: Vec<SurfaceFile>,
    /// The central ray.
    pub path: PathFile,
    /// The virtual planes.
    #[schemars(transform = told("a list of planes", r#"[(name: "arrival", at: Before("floor"))]"#))]
    pub planes: Vec<PlaneFile>,
    /// The window of every plane that has no window of its own.
    pub window: WindowFile,
    /// The frequencies of every plane that has no frequencies of its own.
    pub frequencies: FrequenciesFile,
    /// Whether geometric steps are predicted by the paper's equations as printed (9, 10, 11 and
    /// 19).
    #[serde(default)]
    #[schemars(transform = told("true or false", "true"))]
    pub as_printed: bool,
    /// The settings of the measurement.
    #[serde(default)]
    pub run: RunFile,
}

/// An axis orthogonal to the central ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = told("an axis, X or Y", "X"))]
pub enum AxisName {
    /// Along X.
    X,
    /// Along Y.
    Y,
}

impl AxisName {
    /// Returns 0 for X and 1 for Y.
    #[must_use]
    pub fn index(self) -> usize {
        match self {
            Self::X => 0,
            Self::Y => 1,
        }
    }
}

/// The central ray. It leaves the light's centre and travels from surface to surface; each surface
/// sends it towards the centre of the next.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Path", deny_unknown_fields)]
#[schemars(transform = told("the central ray", r#"(direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["floor"])"#))]
pub struct PathFile {
    /// Direction, of any length, in which the ray leaves the light.
    #[schemars(transform = direction("(0, 0, 1)"))]
    pub direction: [f64; 3],
    /// The X axis; only the part orthogonal to the direction is used.
    #[schemars(transform = direction("(1, 0, 0)"))]
    pub x_axis: [f64; 3],
    /// Names of the surfaces that the ray visits, in the order in which it visits them.
    #[schemars(transform = told("a list of names of surfaces", r#"["floor"]"#))]
    pub visits: Vec<String>,
    /// Direction, of any length, in which the ray leaves the last surface; by default, straight back.
    #[serde(default)]
    #[schemars(transform = direction("(0, 0, -1)"))]
    pub leaves: Option<[f64; 3]>,
}

/// A virtual plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Plane", deny_unknown_fields)]
#[schemars(transform = told("a plane", r#"(name: "arrival", at: Before("floor"))"#))]
pub struct PlaneFile {
    /// Name of the plane, and of the folder of its results.
    #[schemars(transform = told("a name in quotes, 1 to 64 letters, digits, - and _", r#""arrival""#))]
    pub name: String,
    /// Place on the path.
    pub at: Place,
    /// What the plane records.
    #[serde(default)]
    #[schemars(transform = told("Radiance or DifferentialIrradiance", "Radiance"))]
    pub quantity: Quantity,
    /// Reference frame of the plane's coordinates.
    #[serde(default)]
    #[schemars(transform = told("Orthogonal, Tangent, LocalNormals or Mirrored", "Orthogonal"))]
    pub orientation: Orientation,
    /// The plane's own window.
    #[serde(default)]
    pub window: Option<WindowFile>,
    /// The plane's own frequencies.
    #[serde(default)]
    pub frequencies: Option<FrequenciesFile>,
}

/// A place on the path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = told("Emission, Distance(…), Before(…) or After(…)", r#"Before("floor")"#))]
pub enum Place {
    /// At the light; records the light that leaves.
    Emission,
    /// In the plane of these blockers or this surface; records the light that arrives there.
    Before(String),
    /// In the plane of these blockers or this surface; records the light that has passed the
    /// blockers or leaves the surface.
    After(String),
    /// At this distance from the light, along the path.
    Distance(#[schemars(transform = depends("0 to the end of the path"))] f64),
}

/// The window, with a profile for each coordinate. By default, y has the
/// profile of x, and v has the profile of u.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Window", deny_unknown_fields)]
#[schemars(transform = told("a window", "(x: Hann(0.5), u: Hann(0.5))"))]
pub struct WindowFile {
    /// Profile along x, in metres.
    #[schemars(transform = profile_of_place)]
    pub x: Profile,
    /// Profile along y.
    #[serde(default)]
    #[schemars(transform = profile_of_place)]
    pub y: Option<Profile>,
    /// Profile along the slope u.
    #[schemars(transform = profile_of_slope)]
    pub u: Profile,
    /// Profile along the slope v.
    #[serde(default)]
    #[schemars(transform = profile_of_slope)]
    pub v: Option<Profile>,
}

/// The frequencies of the slices.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Frequencies", deny_unknown_fields)]
#[schemars(transform = told("frequencies", "(rho: (max: 16), nu: (max: 32))"))]
pub struct FrequenciesFile {
    /// Number K of azimuths πk/K.
    #[serde(default = "eight", deserialize_with = "count")]
    #[schemars(transform = told("a whole number", "8"), transform = within(1.0, 1024.0))]
    pub azimuths: u32,
    /// Spatial frequency ρ, in cycles per metre.
    #[schemars(transform = told("frequencies in cycles per metre", "(max: 16)"))]
    pub rho: AxisFile,
    /// Angular frequency ν, in cycles per unit slope.
    #[schemars(transform = told("frequencies in cycles per unit slope", "(max: 32)"))]
    pub nu: AxisFile,
}

/// A frequency axis from −max to +max.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Axis", deny_unknown_fields)]
pub struct AxisFile {
    /// Highest frequency, rounded up to a multiple of the spacing.
    #[schemars(transform = told("a frequency in the unit of its axis", "16"))]
    pub max: f64,
    /// Spacing of the frequencies. The default, 1/(2 · half-width of the window), is also the
    /// largest allowed.
    #[serde(default)]
    #[schemars(transform = told("a frequency in the unit of its axis", "0.5"))]
    pub spacing: Option<f64>,
}

/// The settings of the measurement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Run", deny_unknown_fields, default)]
#[schemars(transform = told("how the scene is measured", "(photons: 1e7)"))]
pub struct RunFile {
    /// Number of emitted photons, which may be written as 1e7.
    #[serde(deserialize_with = "count")]
    #[schemars(transform = told("a whole number", "1e7"), transform = depends("at least one for each batch, at most 10^12"))]
    pub photons: u64,
    /// Seed of the photons.
    #[schemars(transform = seed)]
    pub seed: u64,
    /// Number of independent batches, from which errors are estimated.
    #[serde(deserialize_with = "count")]
    #[schemars(transform = told("a whole number", "64"), transform = within(32.0, 1024.0), transform = since("errors are estimated from the spread between batches"))]
    pub batches: u32,
    /// Probability that the verdict rejects a correct scene, for all planes together.
    #[schemars(transform = told("a share of correct scenes that may fail", "0.01"), transform = within(1e-6, 0.5))]
    pub alpha: f64,
    /// Largest noise, as a share of the spectrum, with which a plane passes.
    #[schemars(transform = told("a share of the spectrum", "0.1"), transform = within(1e-4, 1.0))]
    pub resolution: f64,
    /// How photons leave the light.
    pub emission: Emission,
    /// The random numbers from which photons are drawn.
    pub sampling: Sampling,
    /// The number of each colour that is measured. Runs that differ only in it trace the same photons
    /// if there is one light, and it is no environment.
    #[serde(skip_serializing_if = "Color::is_luminance")]
    pub color: Color,
}

impl Default for RunFile {
    fn default() -> Self {
        Self {
            photons: 1 << 23,
            seed: 1,
            batches: 64,
            alpha: 0.01,
            resolution: 0.1,
            emission: Emission::Aimed,
            sampling: Sampling::Lattice,
            color: Color::Luminance,
        }
    }
}

/// A whole number in any notation.
struct Whole<T>(T);

fn count<'de, T: TryFrom<u64>, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
    Whole::deserialize(deserializer).map(|Whole(count)| count)
}

fn counts<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[u32; 2], D::Error> {
    <[Whole<u32>; 2]>::deserialize(deserializer).map(|counts| counts.map(|Whole(count)| count))
}

impl<'de, T: TryFrom<u64>> Deserialize<'de> for Whole<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let count = deserializer.deserialize_any(Count)?;
        let refused = || D::Error::invalid_value(Unexpected::Unsigned(count), &Count);
        T::try_from(count).map(Self).map_err(|_| refused())
    }
}

struct Count;

impl Visitor<'_> for Count {
    type Value = u64;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a whole number, such as 10_000_000 or 1e7")
    }

    fn visit_u64<E>(self, value: u64) -> Result<u64, E> {
        Ok(value)
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<u64, E> {
        whole(value).ok_or_else(|| E::invalid_value(Unexpected::Float(value), &self))
    }
}

/// How photons leave the light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = told("Aimed or Plain", "Aimed"))]
pub enum Emission {
    /// Photons are aimed at the windows of the planes, by one distribution for each window.
    Aimed,
    /// Photons leave as the light emits: their origins are uniform over the area, and the density
    /// of their directions is proportional to the cosine.
    Plain,
}

/// The random numbers from which photons are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = told("Lattice, Net or Random", "Lattice"))]
pub enum Sampling {
    /// Rank-1 lattices for the rays that leave the light, chosen for the frequencies of the planes.
    /// Light that is not aimed, lights without area, and measurements on 4D grids (`--save field`,
    /// `variance`, `covariance`) use nets.
    Lattice,
    /// Scrambled Sobol' nets, one for each batch. They reduce noise, and most for batches of 2ᵐ
    /// photons.
    Net,
    /// Independent random numbers.
    Random,
}

fn one() -> f64 {
    1.0
}

fn white() -> ColorFile {
    1.0.into()
}

fn grey() -> ColorFile {
    0.5.into()
}

fn along_y() -> [f64; 3] {
    [0.0, 1.0, 0.0]
}

fn along_z() -> [f64; 3] {
    [0.0, 0.0, 1.0]
}

fn eight() -> u32 {
    8
}
