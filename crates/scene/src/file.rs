use crate::SceneError;
use etendue_field::{Orientation, Profile, Quantity};
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
    /// Whether geometric steps are predicted by the paper's equations as they are printed (9, 10, 11 and 19).
    #[serde(default)]
    pub as_printed: bool,
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
    /// A Lambertian disc orthogonal to the central ray, dark on its back.
    Disc {
        /// Centre, world coordinates.
        center: [f64; 3],
        /// Radius.
        radius: f64,
        /// Radiance, W m⁻² sr⁻¹.
        #[serde(default = "one")]
        radiance: f64,
    },
    /// A point that shines alike in all directions.
    Point {
        /// Where it is, world coordinates.
        center: [f64; 3],
        /// Intensity, W sr⁻¹.
        #[serde(default = "one")]
        intensity: f64,
    },
    /// A flat bulb whose radiance falls off as cosⁿθ from the central ray.
    Spot {
        /// Centre, world coordinates.
        center: [f64; 3],
        /// Its shape.
        bulb: BulbFile,
        /// Radiance along the central ray, W m⁻² sr⁻¹.
        #[serde(default = "one")]
        radiance: f64,
        /// The exponent n.
        exponent: f64,
    },
    /// A slide projector: a point whose intensity is a picture over slopes.
    Projector {
        /// Where it is, world coordinates.
        center: [f64; 3],
        /// Intensity where the picture is 1, W sr⁻¹.
        #[serde(default = "one")]
        intensity: f64,
        /// The picture, over slopes along X and along Y.
        image: ImageFile,
    },
    /// A collimated beam along the central ray whose irradiance is a picture.
    Beam {
        /// Where the central ray begins, world coordinates.
        center: [f64; 3],
        /// Irradiance where the picture is 1, W m⁻².
        #[serde(default = "one")]
        irradiance: f64,
        /// The picture, in metres along X and along Y.
        image: ImageFile,
    },
    /// Light from far away; that alone shines which comes from before the plane across `path.direction` at the centre.
    Environment {
        /// Where the central ray begins, world coordinates.
        center: [f64; 3],
        /// Direction of the map's top, any length.
        #[serde(default = "along_y")]
        up: [f64; 3],
        /// Direction of the middle of the map, any length: its part orthogonal to `up` is used.
        #[serde(default = "along_z")]
        front: [f64; 3],
        /// Factor on the map.
        #[serde(default = "one")]
        scale: f64,
        /// How much comes from where.
        map: EnvironmentFile,
    },
}

/// Radiance by the direction light comes from; in coordinates whose second axis is `up` and whose third is `front`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum EnvironmentFile {
    /// A sum of lobes.
    Lobes(Vec<SphericalGaussianFile>),
    /// An OpenEXR picture over latitude and longitude, W m⁻² sr⁻¹; the path is relative to the scene file, and stays inside its folder.
    File(String),
}

/// A lobe of light, radiance · exp((cos γ − 1)/width²), γ being the angle to `from`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SphericalGaussianFile {
    /// The direction most of it comes from, any length.
    pub from: [f64; 3],
    /// Its width, radians.
    pub width: f64,
    /// Radiance from that direction, W m⁻² sr⁻¹.
    #[serde(default = "one")]
    pub radiance: f64,
}

/// A smooth picture: exp(−π (a²/w₁² + b²/w₂²)), times a grating ½ (1 + m cos(2π f t + p)) if it has one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImageFile {
    /// w₁ and w₂ along X and along Y.
    pub width: [f64; 2],
    /// Its grating.
    #[serde(default)]
    pub grating: Option<GratingFile>,
}

/// The grating of a picture or a pattern.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GratingFile {
    /// The axis along which it varies.
    pub axis: AxisName,
    /// f, cycles per unit of the picture, or per metre of a surface.
    pub frequency: f64,
    /// m.
    #[serde(default = "one")]
    pub modulation: f64,
    /// p, radians.
    #[serde(default)]
    pub phase: f64,
}

/// The bulb of a spot, orthogonal to the central ray.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum BulbFile {
    /// A square with this side, edges along X and Y.
    Square(f64),
    /// A disc with this radius.
    Disc(f64),
}

/// Black blockers, most of them in one plane orthogonal to the central ray.
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
    /// Opaque shapes one by one; they must not overlap.
    Shapes {
        /// Name.
        name: String,
        /// Point from which their coordinates along X and Y are counted, world coordinates.
        center: [f64; 3],
        /// The shapes.
        shapes: Vec<ShapeFile>,
    },
    /// A semi-transparent cosine grating over the whole plane: ½ (1 + m cos(2π f t + p)), t being x or y.
    Grating {
        /// Name.
        name: String,
        /// Point from which t is counted, world coordinates.
        center: [f64; 3],
        /// The axis along which it varies.
        axis: AxisName,
        /// f, cycles per metre.
        frequency: f64,
        /// m.
        #[serde(default = "one")]
        modulation: f64,
        /// p, radians.
        #[serde(default)]
        phase: f64,
    },
    /// An opaque triangle mesh, anywhere between the light and the end of the path.
    Mesh {
        /// Name.
        name: String,
        /// Where the mesh's origin is put, world coordinates.
        center: [f64; 3],
        /// The triangles.
        mesh: MeshSource,
        /// Factor on the mesh's coordinates.
        #[serde(default = "one")]
        scale: f64,
    },
}

impl BlockersFile {
    /// Their name.
    #[must_use]
    pub fn name(&self) -> &str {
        match self {
            Self::JitteredSquares { name, .. }
            | Self::Shapes { name, .. }
            | Self::Grating { name, .. }
            | Self::Mesh { name, .. } => name,
        }
    }
}

/// A shape in the plane of its blockers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum ShapeFile {
    /// A rectangle, edges along X and Y.
    Rectangle {
        /// Centre along X and Y.
        center: [f64; 2],
        /// Side lengths along X and Y.
        size: [f64; 2],
    },
    /// A disc.
    Disc {
        /// Centre along X and Y.
        center: [f64; 2],
        /// Radius.
        radius: f64,
    },
    /// Everything on one side of a line.
    HalfPlane {
        /// The axis along which the coordinate is compared with the edge.
        axis: AxisName,
        /// Coordinate of the edge.
        edge: f64,
        /// The side that is opaque.
        opaque: HalfName,
    },
}

/// An axis across the central ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum AxisName {
    /// Along X.
    X,
    /// Along Y.
    Y,
}

impl AxisName {
    /// 0 for X, 1 for Y.
    #[must_use]
    pub fn index(self) -> usize {
        match self {
            Self::X => 0,
            Self::Y => 1,
        }
    }
}

/// A side of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum HalfName {
    /// Coordinates below the edge.
    Below,
    /// Coordinates above the edge.
    Above,
}

/// Where a mesh comes from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum MeshSource {
    /// An OBJ or PLY file; the path is relative to the scene file, and stays inside its folder.
    File(String),
    /// A generated piece of the paraboloid z = −(k₁ x² + k₂ y²)/2 around the origin, facing along z: see
    /// [`Mesh::paraboloid`](crate::Mesh::paraboloid).
    Paraboloid {
        /// k₁ and k₂, per metre: positive if it is convex.
        curvatures: [f64; 2],
        /// It reaches to ± this along x and along y.
        half: f64,
        /// Cells along a side, of two triangles each.
        cells: u32,
    },
    /// A generated closed surface around the origin: see [`Mesh::star`](crate::Mesh::star).
    Star {
        /// Mean radius.
        radius: f64,
        /// Height of the lobes as a share of the radius.
        relief: f64,
        /// Number of lobes around the axis.
        lobes: u32,
        /// Rings from pole to pole.
        rings: u32,
    },
}

/// A Lambertian surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum SurfaceFile {
    /// A rectangle, edges along X and Y unless it faces elsewhere.
    Rectangle {
        /// Name, for the path and the planes to refer to.
        name: String,
        /// Centre, world coordinates.
        center: [f64; 3],
        /// Side lengths along X and Y.
        size: [f64; 2],
        /// Its normal, any length: back along `path.direction` unless stated. Its edges are then along the part of the path's
        /// X axis that is orthogonal to it (of Y, if X is along it), and across.
        #[serde(default)]
        facing: Option<[f64; 3]>,
        /// Reflected over incident flux.
        #[serde(default = "half")]
        albedo: f64,
    },
    /// A triangle mesh, Lambertian on both sides.
    Mesh {
        /// Name.
        name: String,
        /// Where the mesh's origin is put, world coordinates.
        center: [f64; 3],
        /// The triangles.
        mesh: MeshSource,
        /// Factor on the mesh's coordinates.
        #[serde(default = "one")]
        scale: f64,
        /// Reflected over incident flux, if it is Lambertian.
        #[serde(default = "half")]
        albedo: f64,
        /// What it does to light as a smooth surface, with normals interpolated between its vertices.
        #[serde(default)]
        event: Option<EventFile>,
    },
    /// A smooth piece of a plane, sphere, cylinder or paraboloid that reflects or refracts.
    Smooth {
        /// Name.
        name: String,
        /// Its vertex, world coordinates.
        center: [f64; 3],
        /// Its normal at the vertex, any length.
        facing: [f64; 3],
        /// Its form.
        form: FormFile,
        /// Direction of the first curvature, any length: the path's X axis unless stated (Y, if it faces along X); its part
        /// orthogonal to the normal is used.
        #[serde(default)]
        along: Option<[f64; 3]>,
        /// Its radius, seen along the normal.
        aperture: f64,
        /// What it does.
        event: EventFile,
    },
}

impl SurfaceFile {
    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        match self {
            Self::Rectangle { name, .. } | Self::Mesh { name, .. } | Self::Smooth { name, .. } => {
                name
            }
        }
    }
}

/// The form of a smooth surface around its vertex; curvatures per metre, positive if it is convex seen from where it faces.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum FormFile {
    /// Flat.
    Plane,
    /// A sphere with this curvature, 1/R.
    Sphere(f64),
    /// A circular cylinder with this curvature; its axis is across `along`.
    Cylinder(f64),
    /// A paraboloid with these curvatures at its vertex, the first along `along`.
    Paraboloid(f64, f64),
}

/// What a smooth surface does to light.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum EventFile {
    /// Reflects it all.
    Mirror,
    /// Lets it through by Snell's law; nothing is reflected.
    Refraction {
        /// Index of refraction on the side it faces.
        front: f64,
        /// Index on the other side.
        back: f64,
    },
    /// A thin lens, flat, with this focal length.
    ThinLens(f64),
    /// Reflects by a BRDF, on the side it faces; black on the other.
    Reflects {
        /// The BRDF.
        brdf: BrdfFile,
        /// Another BRDF that takes its place where the pattern of the blend is 0.
        #[serde(default)]
        other: Option<BrdfFile>,
        /// How the two are blended.
        #[serde(default)]
        blend: Option<PatternFile>,
        /// What multiplies the BRDF.
        #[serde(default)]
        texture: Option<PatternFile>,
    },
}

/// A BRDF.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BrdfFile {
    /// Its lobe.
    pub lobe: LobeFile,
    /// Factor on it, 0 to 1.
    #[serde(default = "one")]
    pub albedo: f64,
    /// Its Fresnel factor.
    #[serde(default)]
    pub fresnel: FresnelFile,
}

/// The lobe of a BRDF.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum LobeFile {
    /// Alike in all directions.
    Lambertian,
    /// cosⁿ of the angle to the mirror direction, with this n.
    Phong(f64),
    /// Microfacets with Beckmann's distribution of normals, with this roughness α.
    Beckmann(f64),
    /// Microfacets with the GGX distribution, with this roughness α.
    Ggx(f64),
}

/// The share of light that is reflected, by the angle of incidence.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum FresnelFile {
    /// All of it.
    #[default]
    White,
    /// At a dielectric with this index of refraction.
    Dielectric(f64),
    /// At a conductor with index n + i k.
    Conductor {
        /// n.
        n: f64,
        /// k.
        k: f64,
    },
}

/// A number from 0 to 1 at each place of a surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum PatternFile {
    /// ½ (1 + m cos(2π f t + p)), t along `along` or across it.
    Cosine {
        /// The axis along which it varies: X is `along`.
        axis: AxisName,
        /// f, cycles per metre.
        frequency: f64,
        /// m.
        #[serde(default = "one")]
        modulation: f64,
        /// p, radians.
        #[serde(default)]
        phase: f64,
    },
    /// 1 and 0 by turns on squares; two of their sides make this period.
    Checkerboard(f64),
    /// A picture around the vertex, 0 beyond its edge: X to its right, Y to its top, seen from where the surface faces.
    Picture {
        /// An OpenEXR or PNG file of numbers from 0 to 1; the path is relative to the scene file, and stays inside its folder.
        file: String,
        /// Width along X and height along Y, metres.
        size: [f64; 2],
    },
}

/// The central ray: it leaves the light's centre and goes from surface to surface, each sending it towards the centre of the
/// next.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PathFile {
    /// Direction in which it leaves the light; any length.
    pub direction: [f64; 3],
    /// The X axis: its part orthogonal to the direction is used.
    pub x_axis: [f64; 3],
    /// Names of the surfaces it visits, in the order of light.
    pub visits: Vec<String>,
    /// Direction in which it leaves the last of them, any length: straight back unless stated.
    #[serde(default)]
    pub leaves: Option<[f64; 3]>,
}

/// A virtual plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlaneFile {
    /// Name: the folder of its results.
    pub name: String,
    /// Where on the path.
    pub at: Place,
    /// What it records.
    #[serde(default)]
    pub quantity: Quantity,
    /// What its coordinates are counted from.
    #[serde(default)]
    pub orientation: Orientation,
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
    /// In the plane of these blockers, after them; or of this surface, as light leaves it.
    After(String),
    /// At this distance from the light, along the path.
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

fn along_y() -> [f64; 3] {
    [0.0, 1.0, 0.0]
}

fn along_z() -> [f64; 3] {
    [0.0, 0.0, 1.0]
}

fn half() -> f64 {
    0.5
}

fn eight() -> u32 {
    8
}

impl SceneFile {
    /// The files of meshes and pictures it names.
    pub fn named_files(&self) -> impl Iterator<Item = &str> {
        let blockers = self.blockers.iter().filter_map(|b| match b {
            BlockersFile::Mesh { mesh, .. } => Some(mesh),
            _ => None,
        });
        let surfaces = self.surfaces.iter().filter_map(|s| match s {
            SurfaceFile::Mesh { mesh, .. } => Some(mesh),
            SurfaceFile::Rectangle { .. } | SurfaceFile::Smooth { .. } => None,
        });
        let meshes = blockers.chain(surfaces).filter_map(|mesh| match mesh {
            MeshSource::File(path) => Some(path.as_str()),
            MeshSource::Star { .. } | MeshSource::Paraboloid { .. } => None,
        });
        let environment = match &self.light {
            LightFile::Environment {
                map: EnvironmentFile::File(path),
                ..
            } => Some(path.as_str()),
            _ => None,
        };
        let patterns = self.surfaces.iter().filter_map(|s| match s {
            SurfaceFile::Smooth {
                event: EventFile::Reflects { blend, texture, .. },
                ..
            } => Some([blend, texture]),
            _ => None,
        });
        let pictures = patterns.flatten().filter_map(|pattern| match pattern {
            Some(PatternFile::Picture { file, .. }) => Some(file.as_str()),
            _ => None,
        });
        meshes.chain(environment).chain(pictures)
    }

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
