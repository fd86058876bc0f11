//! Surfaces and what they do to light, as written.

use super::{AxisName, count, half, one};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Where a mesh comes from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum MeshSource {
    /// An OBJ or PLY file; the path is relative to the scene file, and stays inside its folder.
    File(String),
    /// A generated piece of the paraboloid z = −(k₁ x² + k₂ y²)/2 around the origin, facing along z.
    Paraboloid {
        /// k₁ and k₂, per metre: positive if it is convex.
        curvatures: [f64; 2],
        /// It reaches to ± this along x and along y.
        half: f64,
        /// Cells along a side, of two triangles each.
        #[serde(deserialize_with = "count")]
        cells: u32,
    },
    /// A generated closed surface around the origin, r = radius · (1 + relief · sinˡθ · cos lφ) with l lobes around z.
    Star {
        /// Mean radius.
        radius: f64,
        /// Height of the lobes as a share of the radius.
        relief: f64,
        /// Number of lobes around the axis.
        #[serde(deserialize_with = "count")]
        lobes: u32,
        /// Rings from pole to pole.
        #[serde(deserialize_with = "count")]
        rings: u32,
    },
}

/// What light falls on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Surface", deny_unknown_fields)]
pub enum SurfaceFile {
    /// A Lambertian rectangle, edges along X and Y unless it faces elsewhere.
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
    /// A triangle mesh, Lambertian on both sides unless it is smooth.
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
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Form")]
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Event", deny_unknown_fields)]
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
        /// Another BRDF that is added to it, weighted by 1 − `blend`.
        #[serde(default)]
        other: Option<Box<BrdfFile>>,
        /// What weights the BRDF where there is another.
        #[serde(default)]
        blend: Option<PatternFile>,
        /// What multiplies the BRDF.
        #[serde(default)]
        texture: Option<PatternFile>,
    },
    /// Reflects by a weighted sum of BRDFs, on the side it faces; black on the other.
    Sum {
        /// The BRDFs with their weights, 1 to 8 of them. The first says where the central ray goes on, as far as the path does not.
        terms: Vec<TermFile>,
        /// What multiplies their sum.
        #[serde(default)]
        texture: Option<PatternFile>,
    },
}

/// A BRDF of a sum.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Term", deny_unknown_fields)]
pub struct TermFile {
    /// The BRDF.
    pub brdf: BrdfFile,
    /// How much of it there is at each place: 1 unless stated.
    #[serde(default)]
    pub weight: Option<PatternFile>,
}

/// A BRDF.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Brdf", deny_unknown_fields)]
pub struct BrdfFile {
    /// Its lobe.
    pub lobe: LobeFile,
    /// Factor on it, 0 to 1.
    #[serde(default = "one")]
    pub albedo: f64,
    /// Its Fresnel factor.
    #[serde(default)]
    pub fresnel: FresnelFile,
    /// A factor of the angle at which light comes: values at equal steps from the normal to 90 degrees, linear in between; 1 unless stated.
    #[serde(default)]
    pub incoming: Option<Vec<f64>>,
    /// The same of the angle at which light leaves.
    #[serde(default)]
    pub outgoing: Option<Vec<f64>>,
}

/// The lobe of a BRDF.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Lobe")]
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Fresnel", deny_unknown_fields)]
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Pattern", deny_unknown_fields)]
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
