//! The surfaces of a scene file and their interaction with light.

use super::allowed::{
    albedo, cycles, depends, direction, factor, factors_by_angle, length, modulation, name, phase,
    place, sides, told, within,
};
use super::{AxisName, ColorFile, count, grey, one, white};
use crate::limits::CELLS;
use etendue_field::Lobe;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The source of a mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(transform = told("a mesh", r#"File("mesh.obj")"#))]
pub enum MeshSource {
    /// An OBJ or PLY file; the path is relative to the scene file, and must stay inside its folder.
    File(String),
    /// A generated piece of the paraboloid z = −(k₁ x² + k₂ y²)/2 around the origin, facing along z.
    Paraboloid {
        /// Curvatures k₁ and k₂ per metre, positive if convex.
        #[schemars(transform = told("curvatures along X and Y per metre", "(1, 0.5)"), transform = within(-1e6, 1e6))]
        curvatures: [f64; 2],
        /// Half-width: the piece extends from −half to half along x and along y.
        #[schemars(transform = length, transform = within(1e-9, 1e8))]
        half: f64,
        /// Number of cells along a side; each cell consists of two triangles.
        #[serde(deserialize_with = "count")]
        #[schemars(transform = told("a whole number", "16"), transform = within(1.0, f64::from(CELLS)))]
        cells: u32,
    },
    /// A generated closed surface around the origin, r = radius · (1 + relief · sinˡθ · cos lφ) with l lobes around z.
    Star {
        /// Mean radius.
        #[schemars(transform = length, transform = within(1e-9, 1e8))]
        radius: f64,
        /// Height of the lobes as a share of the radius.
        #[schemars(transform = told("a share of the radius", "0.3"), transform = within(-0.9, 0.9))]
        relief: f64,
        /// Number of lobes around the axis.
        #[serde(deserialize_with = "count")]
        #[schemars(transform = told("a whole number", "5"), transform = depends("0 to half the rings"))]
        lobes: u32,
        /// Number of rings from pole to pole.
        #[serde(deserialize_with = "count")]
        #[schemars(transform = told("a whole number", "32"), transform = within(2.0, f64::from(CELLS)))]
        rings: u32,
    },
}

/// A surface that light falls on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Surface", deny_unknown_fields)]
#[schemars(transform = told("a surface", r#"Rectangle(name: "floor", center: (0, 0, 2), size: (6, 6))"#))]
pub enum SurfaceFile {
    /// A Lambertian rectangle, with edges along X and Y by default. For a mirror or a glossy
    /// surface, use `Smooth` with `form: Plane`.
    Rectangle {
        /// Name by which the path and the planes refer to the surface.
        #[schemars(transform = name)]
        name: String,
        /// Centre, in world coordinates.
        #[schemars(transform = place)]
        center: [f64; 3],
        /// Side lengths along X and Y.
        #[schemars(transform = sides)]
        size: [f64; 2],
        /// Normal of the rectangle, of any length; by default, opposite to `path.direction`. One pair
        /// of edges is along the part of the path's X axis that is orthogonal to the normal; if X
        /// is along the normal, the Y axis is used. The other pair is orthogonal to the first.
        #[serde(default)]
        #[schemars(transform = direction("(0, 0, -1)"))]
        facing: Option<[f64; 3]>,
        /// Albedo: the ratio of reflected to incident flux.
        #[serde(default = "grey")]
        #[schemars(transform = albedo)]
        albedo: ColorFile,
    },
    /// A triangle mesh, Lambertian on both sides unless it is smooth.
    Mesh {
        /// Name.
        #[schemars(transform = name)]
        name: String,
        /// Position of the mesh's origin, in world coordinates.
        #[schemars(transform = place)]
        center: [f64; 3],
        /// The triangles.
        mesh: MeshSource,
        /// Scale factor of the mesh's coordinates.
        #[serde(default = "one")]
        #[schemars(transform = factor)]
        scale: f64,
        /// Albedo (the ratio of reflected to incident flux), if the mesh is Lambertian.
        #[serde(default = "grey")]
        #[schemars(transform = albedo)]
        albedo: ColorFile,
        /// Interaction with light as a smooth surface, with normals interpolated between vertices.
        #[serde(default)]
        event: Option<EventFile>,
    },
    /// A smooth piece of a plane, sphere, cylinder or paraboloid that reflects or refracts.
    Smooth {
        /// Name.
        #[schemars(transform = name)]
        name: String,
        /// Vertex of the surface, in world coordinates.
        #[schemars(transform = place)]
        center: [f64; 3],
        /// Normal at the vertex, of any length.
        #[schemars(transform = direction("(0, 0, -1)"))]
        facing: [f64; 3],
        /// Shape of the surface.
        form: FormFile,
        /// Direction, of any length, of the first curvature; by default, the path's X axis (or Y, if
        /// the surface faces along X). Only the part orthogonal to the normal is used.
        #[serde(default)]
        #[schemars(transform = direction("(1, 0, 0)"))]
        along: Option<[f64; 3]>,
        /// Radius of the surface, seen along the normal.
        #[schemars(transform = length)]
        aperture: f64,
        /// Interaction with light.
        event: EventFile,
    },
}

impl SurfaceFile {
    /// The name of the surface.
    #[must_use]
    pub fn name(&self) -> &str {
        match self {
            Self::Rectangle { name, .. } | Self::Mesh { name, .. } | Self::Smooth { name, .. } => {
                name
            }
        }
    }
}

/// The shape of a smooth surface around its vertex. Curvatures are per metre, and positive if the
/// surface is convex as seen from the side that it faces.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Form")]
#[schemars(transform = told("a form with its curvature", "Sphere(0.5)"))]
pub enum FormFile {
    /// Flat.
    Plane,
    /// A sphere with this curvature, 1/R.
    Sphere(#[schemars(transform = within(-1e6, 1e6))] f64),
    /// A circular cylinder with this curvature, whose axis is orthogonal to `along`.
    Cylinder(#[schemars(transform = within(-1e6, 1e6))] f64),
    /// A paraboloid with these curvatures at its vertex, the first along `along`.
    Paraboloid(
        #[schemars(transform = within(-1e6, 1e6))] f64,
        #[schemars(transform = within(-1e6, 1e6))] f64,
    ),
}

/// The interaction of a smooth surface with light.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Event", deny_unknown_fields)]
#[schemars(transform = told("what happens to light", "Refraction(front: 1, back: 1.5)"))]
pub enum EventFile {
    /// Reflects all light.
    Mirror,
    /// Transmits light by Snell's law; nothing is reflected.
    Refraction {
        /// Index of refraction on the side that the surface faces.
        #[schemars(transform = told("an index of refraction", "1"), transform = within(0.1, 10.0))]
        front: f64,
        /// Index of refraction on the other side.
        #[schemars(transform = told("an index of refraction", "1.5"), transform = within(0.1, 10.0))]
        back: f64,
    },
    /// A flat thin lens with this focal length.
    ThinLens(
        #[schemars(transform = depends("a focal length in metres, other than 0, and negative if the lens spreads light"))]
         f64,
    ),
    /// Reflects by a BRDF on the side that the surface faces; the other side is black.
    Reflects {
        /// The BRDF.
        brdf: BrdfFile,
        /// A second BRDF that is added, weighted by 1 − `blend`.
        #[serde(default)]
        other: Option<Box<BrdfFile>>,
        /// Weight of the first BRDF if there is a second BRDF.
        #[serde(default)]
        blend: Option<PatternFile>,
        /// Factor that multiplies the BRDF.
        #[serde(default)]
        texture: Option<PatternFile>,
    },
    /// Reflects by a weighted sum of BRDFs on the side that the surface faces; the other side is
    /// black.
    Sum {
        /// 1 to 8 BRDFs with their weights. If the path does not set the direction in which the
        /// central ray leaves, the first BRDF determines it.
        #[schemars(transform = told("a list of BRDFs with weights", "[(brdf: (lobe: Phong(100)), weight: Checkerboard(0.1))]"))]
        terms: Vec<TermFile>,
        /// Factor that multiplies the sum.
        #[serde(default)]
        texture: Option<PatternFile>,
    },
}

/// A term in a sum of BRDFs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Term", deny_unknown_fields)]
#[schemars(transform = told("a BRDF with its weight", "(brdf: (lobe: Phong(100)), weight: Checkerboard(0.1))"))]
pub struct TermFile {
    /// The BRDF.
    pub brdf: BrdfFile,
    /// Weight of the BRDF at each place; 1 by default.
    #[serde(default)]
    pub weight: Option<PatternFile>,
}

/// A BRDF.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Brdf", deny_unknown_fields)]
#[schemars(transform = told("a BRDF", "(lobe: Phong(100))"))]
pub struct BrdfFile {
    /// Lobe of the BRDF.
    pub lobe: LobeFile,
    /// Factor that multiplies the lobe, 0 to 1.
    #[serde(default = "white")]
    #[schemars(transform = albedo)]
    pub albedo: ColorFile,
    /// Fresnel factor.
    #[serde(default)]
    pub fresnel: FresnelFile,
    /// Factor that depends on the angle of incidence. Its values, at equal steps from the normal to
    /// 90 degrees, are interpolated linearly; 1 by default.
    #[serde(default)]
    #[schemars(transform = factors_by_angle)]
    pub incoming: Option<Vec<f64>>,
    /// Factor that depends on the angle of the outgoing light, in the same form.
    #[serde(default)]
    #[schemars(transform = factors_by_angle)]
    pub outgoing: Option<Vec<f64>>,
}

/// The lobe of a BRDF.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Lobe")]
#[schemars(transform = told("a lobe", "Phong(100)"))]
pub enum LobeFile {
    /// Uniform in all directions.
    Lambertian,
    /// Phong lobe: cosⁿ of the angle to the mirror direction, with this exponent n.
    Phong(#[schemars(transform = within(0.0, 1e4))] f64),
    /// Microfacets with Beckmann's distribution of normals, with this roughness α.
    Beckmann(#[schemars(transform = within(1e-3, 1.0))] f64),
    /// Microfacets with the GGX distribution, with this roughness α.
    Ggx(#[schemars(transform = within(1e-3, 1.0))] f64),
}

impl From<LobeFile> for Lobe {
    fn from(file: LobeFile) -> Self {
        match file {
            LobeFile::Lambertian => Self::Lambertian,
            LobeFile::Phong(exponent) => Self::Phong { exponent },
            LobeFile::Beckmann(roughness) => Self::Beckmann { roughness },
            LobeFile::Ggx(roughness) => Self::Ggx { roughness },
        }
    }
}

/// The share of light that is reflected, as a function of the angle of incidence.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Fresnel", deny_unknown_fields)]
#[schemars(transform = told("a Fresnel factor", "Dielectric(1.5)"))]
pub enum FresnelFile {
    /// All light is reflected.
    #[default]
    White,
    /// Reflection at a dielectric with this index of refraction.
    Dielectric(#[schemars(transform = within(0.05, 20.0))] f64),
    /// Reflection at a conductor with index n + i k.
    Conductor {
        /// Index of refraction n.
        #[schemars(transform = told("an index of refraction, or three for red, green and blue", "1.5"), transform = within(0.05, 20.0))]
        n: ColorFile,
        /// Index of absorption k.
        #[schemars(transform = told("an index of absorption, or three for red, green and blue", "3"), transform = within(0.0, 20.0))]
        k: ColorFile,
    },
}

/// A number from 0 to 1 at each place of a surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Pattern", deny_unknown_fields)]
#[schemars(transform = told("a pattern", "Checkerboard(0.1)"))]
pub enum PatternFile {
    /// ½ (1 + m cos(2π f t + p)), where t is measured along `along` or orthogonal to it.
    Cosine {
        /// The axis along which the pattern varies; X is `along`.
        axis: AxisName,
        /// Frequency f, in cycles per metre.
        #[schemars(transform = cycles)]
        frequency: f64,
        /// Modulation m.
        #[serde(default = "one")]
        #[schemars(transform = modulation)]
        modulation: f64,
        /// Phase p, in radians.
        #[serde(default)]
        #[schemars(transform = phase)]
        phase: f64,
    },
    /// A checkerboard of the values 1 and 0 with this period, which is twice the side of a square.
    Checkerboard(f64),
    /// A picture centred on the vertex, with the value 0 outside. The levels of a PNG file count as
    /// they are stored, without the transfer curve of sRGB. X points to its right and Y to its top,
    /// as seen from the side that the surface faces.
    Picture {
        /// An OpenEXR or PNG file of numbers from 0 to 1; the path is relative to the scene file,
        /// and must stay inside its folder.
        #[schemars(transform = told("a file in quotes", r#""picture.exr""#))]
        file: String,
        /// Width along X and height along Y, in metres.
        #[schemars(transform = sides)]
        size: [f64; 2],
    },
}
