use crate::SceneError;
use etendue_field::Profile;
use serde::{Deserialize, Serialize};

/// A scene file as written, in RON. Lengths in metres; slopes are tangents of angles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// What the scene shows, for the reader.
    #[serde(default)]
    pub description: String,
    /// Where light comes from.
    pub light: LightFile,
    /// What stands in its way.
    #[serde(default)]
    pub blockers: Vec<BlockersFile>,
    /// What it falls on.
    #[serde(default)]
    pub surfaces: Vec<SurfaceFile>,
    /// The central ray.
    pub path: PathFile,
    /// Where light is looked at.
    pub planes: Vec<PlaneFile>,
    /// The window of every plane that does not state its own.
    pub window: WindowFile,
    /// The frequencies of every plane that does not state its own.
    pub frequencies: FrequenciesFile,
    /// How it is measured.
    #[serde(default)]
    pub run: RunFile,
}

/// The light. The central ray leaves its centre.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum LightFile {
    /// A Lambertian rectangle orthogonal to the central ray, edges along X and Y, dark on its back.
    Rectangle {
        /// Centre, world coordinates.
        center: [f64; 3],
        /// Side lengths along X and Y.
        size: [f64; 2],
        /// Radiance, W m⁻² sr⁻¹.
        #[serde(default = "one")]
        radiance: f64,
    },
}

/// Opaque, black blockers in one plane orthogonal to the central ray.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum BlockersFile {
    /// `count[0]` × `count[1]` squares on a jittered grid, edges along X and Y.
    JitteredSquares {
        /// Name, for planes to refer to.
        name: String,
        /// Centre of the grid, world coordinates.
        center: [f64; 3],
        /// Squares along X and along Y.
        count: [u32; 2],
        /// Distance between grid points.
        pitch: f64,
        /// Side of a square as a share of the pitch.
        fill: f64,
        /// Each square is moved by U(−jitter/2, jitter/2) pitches along X and along Y.
        #[serde(default)]
        jitter: f64,
        /// Seed of the jitter.
        #[serde(default)]
        seed: u64,
    },
}

/// A Lambertian rectangle orthogonal to the central ray, edges along X and Y.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SurfaceFile {
    /// Name, for the path and the planes to refer to.
    pub name: String,
    /// Centre, world coordinates.
    pub center: [f64; 3],
    /// Side lengths along X and Y.
    pub size: [f64; 2],
    /// Reflected over incident flux.
    #[serde(default = "half")]
    pub albedo: f64,
}

/// The central ray: it leaves the light's centre and ends on the surface it visits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PathFile {
    /// Direction in which it leaves the light; any length.
    pub direction: [f64; 3],
    /// The X axis: its part orthogonal to the direction is used.
    pub x_axis: [f64; 3],
    /// Names of the surfaces it visits, in order.
    pub visits: Vec<String>,
}

/// A virtual plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlaneFile {
    /// Name: the folder of its results.
    pub name: String,
    /// Where on the path.
    pub at: Place,
    /// Its own window.
    #[serde(default)]
    pub window: Option<WindowFile>,
    /// Its own frequencies.
    #[serde(default)]
    pub frequencies: Option<FrequenciesFile>,
}

/// A place on the path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Place {
    /// At the light, as it leaves.
    Emission,
    /// In the plane of these blockers or this surface, before light meets them.
    Before(String),
    /// In the plane of these blockers, after them.
    After(String),
    /// At this distance from the light.
    Distance(f64),
}

/// The window: a profile for each coordinate; y and v are as x and u unless stated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WindowFile {
    /// Along x, metres.
    pub x: Profile,
    /// Along y.
    #[serde(default)]
    pub y: Option<Profile>,
    /// Along u, slope.
    pub u: Profile,
    /// Along v.
    #[serde(default)]
    pub v: Option<Profile>,
}

/// The frequencies of the slices.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrequenciesFile {
    /// Number K of azimuths πk/K.
    #[serde(default = "eight")]
    pub azimuths: u32,
    /// Spatial frequency ρ, cycles per metre.
    pub rho: AxisFile,
    /// Angular frequency ν, cycles per unit slope.
    pub nu: AxisFile,
}

/// A frequency axis from −max to +max.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisFile {
    /// Highest frequency, rounded up to a multiple of the spacing.
    pub max: f64,
    /// Spacing; 1/(2 · half-width of the window) unless stated, and never wider.
    #[serde(default)]
    pub spacing: Option<f64>,
}

/// How the scene is measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RunFile {
    /// Photons emitted.
    pub photons: u64,
    /// Seed of the photons.
    pub seed: u64,
    /// Independent batches the errors come from.
    pub batches: u32,
    /// Share of true scenes the verdict may reject, over all planes.
    pub alpha: f64,
    /// How photons leave the light.
    pub emission: Emission,
}

impl Default for RunFile {
    fn default() -> Self {
        Self {
            photons: 10_000_000,
            seed: 1,
            batches: 64,
            alpha: 0.01,
            emission: Emission::Aimed,
        }
    }
}

/// How photons leave the light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Emission {
    /// At the windows of the planes: a mixture of one proposal for each.
    Aimed,
    /// As light does: uniformly over the area, by the cosine over direction.
    Plain,
}

fn one() -> f64 {
    1.0
}

fn half() -> f64 {
    0.5
}

fn eight() -> u32 {
    8
}

impl SceneFile {
    /// Reads a scene file.
    ///
    /// # Errors
    /// [`SceneError::Syntax`] with line, column and what is allowed there.
    pub fn parse(text: &str) -> Result<Self, SceneError> {
        ron::Options::default()
            .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
            .from_str(text)
            .map_err(|error| SceneError::Syntax {
                line: error.span.start.line,
                column: error.span.start.col,
                message: error.code.to_string(),
            })
    }
}
