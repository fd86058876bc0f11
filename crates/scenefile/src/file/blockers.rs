//! The blockers of a scene file.

use super::allowed::{
    any, cycles, depends, factor, length, modulation, name_of_blockers, phase, place, seed, sides,
    told, within,
};
use super::{AxisName, MeshSource, count, counts, one};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Black blockers. Each group except a mesh lies in one plane orthogonal to the central ray.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Blockers", deny_unknown_fields)]
#[schemars(transform = told("blockers", r#"Grating(name: "bars", center: (0, 0, 1), axis: X, frequency: 5)"#))]
pub enum BlockersFile {
    /// `count[0]` × `count[1]` squares on a jittered grid, with edges along X and Y.
    JitteredSquares {
        /// Name by which planes refer to the blockers.
        #[schemars(transform = name_of_blockers)]
        name: String,
        /// Centre of the grid, in world coordinates.
        #[schemars(transform = place)]
        center: [f64; 3],
        /// Number of squares along X and along Y.
        #[serde(deserialize_with = "counts")]
        #[schemars(transform = told("whole numbers along X and Y", "(20, 20)"), transform = depends("1 to 100000 squares in all"))]
        count: [u32; 2],
        /// Distance between grid points.
        #[schemars(transform = length)]
        pitch: f64,
        /// Side of a square as a share of the pitch.
        #[schemars(transform = told("a share of the pitch", "0.6"), transform = depends("above 0, at most 1"))]
        fill: f64,
        /// Amount of jitter: each square is moved along X and along Y by a random number of pitches,
        /// uniform in (−jitter/2, jitter/2).
        #[serde(default)]
        #[schemars(transform = told("a share of the pitch", "0.3"), transform = depends("0 to 1 − fill"))]
        jitter: f64,
        /// Seed of the jitter.
        #[serde(default)]
        #[schemars(transform = seed)]
        seed: u64,
    },
    /// Opaque bars with equal spacing. Each bar ends 10⁹ m from the central ray on either side.
    Bars {
        /// Name.
        #[schemars(transform = name_of_blockers)]
        name: String,
        /// Centre of the bars, in world coordinates.
        #[schemars(transform = place)]
        center: [f64; 3],
        /// The axis across the bars.
        axis: AxisName,
        /// Number of bars.
        #[serde(deserialize_with = "count")]
        #[schemars(transform = told("a whole number", "5"), transform = within(1.0, 100_000.0))]
        count: u32,
        /// Distance between the centres of neighbouring bars.
        #[schemars(transform = length)]
        pitch: f64,
        /// Width of a bar as a share of the pitch.
        #[schemars(transform = told("a share of the pitch", "0.5"), transform = within(1e-9, 1.0))]
        fill: f64,
    },
    /// Opaque pixels of a picture: a pixel is opaque if its value, or the luminance or selected
    /// channel of its colour, is below 0.5; alpha is ignored. The levels of a PNG file count as they
    /// are stored, without the transfer curve of sRGB. X points to the right of the picture and Y
    /// to its top; outside, all is clear.
    Picture {
        /// Name.
        #[schemars(transform = name_of_blockers)]
        name: String,
        /// Centre of the picture, in world coordinates.
        #[schemars(transform = place)]
        center: [f64; 3],
        /// An OpenEXR or PNG file of numbers from 0 to 1; the path is relative to the scene file,
        /// and must stay inside its folder.
        #[schemars(transform = told("a file in quotes", r#""mask.png""#))]
        file: String,
        /// Width along X and height along Y, in metres.
        #[schemars(transform = sides)]
        size: [f64; 2],
    },
    /// Individual opaque shapes, which must not overlap.
    Shapes {
        /// Name.
        #[schemars(transform = name_of_blockers)]
        name: String,
        /// Origin of the shapes' X and Y coordinates, in world coordinates.
        #[schemars(transform = place)]
        center: [f64; 3],
        /// The shapes.
        #[schemars(transform = told("a list of shapes", "[Disc(center: (0, 0), radius: 0.1)]"))]
        shapes: Vec<ShapeFile>,
    },
    /// An opaque screen over the whole plane, with one hole.
    Aperture {
        /// Name.
        #[schemars(transform = name_of_blockers)]
        name: String,
        /// Origin of the hole's X and Y coordinates, in world coordinates.
        #[schemars(transform = place)]
        center: [f64; 3],
        /// The hole; light passes only through it.
        hole: HoleFile,
    },
    /// A semi-transparent cosine grating over the whole plane: ½ (1 + m cos(2π f t + p)), where t is x or y.
    Grating {
        /// Name.
        #[schemars(transform = name_of_blockers)]
        name: String,
        /// Origin of t, in world coordinates.
        #[schemars(transform = place)]
        center: [f64; 3],
        /// The axis along which the grating varies.
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
        #[schemars(transform = phase, transform = within(-1e3, 1e3))]
        phase: f64,
    },
    /// An opaque triangle mesh, anywhere between the light and the end of the path.
    Mesh {
        /// Name.
        #[schemars(transform = name_of_blockers)]
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
    },
}

impl BlockersFile {
    /// The name of the blockers.
    #[must_use]
    pub fn name(&self) -> &str {
        match self {
            Self::JitteredSquares { name, .. }
            | Self::Bars { name, .. }
            | Self::Picture { name, .. }
            | Self::Shapes { name, .. }
            | Self::Aperture { name, .. }
            | Self::Grating { name, .. }
            | Self::Mesh { name, .. } => name,
        }
    }
}

/// An opaque shape in the plane of a group of blockers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Shape", deny_unknown_fields)]
#[schemars(transform = told("a shape", "Rectangle(center: (0, 0), size: (0.1, 0.1))"))]
pub enum ShapeFile {
    /// A rectangle with edges along X and Y.
    Rectangle {
        /// Centre along X and Y.
        #[schemars(transform = told("a place along X and Y, in metres", "(0.1, 0.2)"), transform = any)]
        center: [f64; 2],
        /// Side lengths along X and Y.
        #[schemars(transform = sides)]
        size: [f64; 2],
    },
    /// A disc.
    Disc {
        /// Centre along X and Y.
        #[schemars(transform = told("a place along X and Y, in metres", "(0.1, 0.2)"), transform = any)]
        center: [f64; 2],
        /// Radius.
        #[schemars(transform = length)]
        radius: f64,
    },
    /// Everything on one side of a line.
    HalfPlane {
        /// The axis along which the coordinate is compared with the edge.
        axis: AxisName,
        /// Coordinate of the edge.
        #[schemars(transform = told("a place in metres", "0.2"), transform = any)]
        edge: f64,
        /// The side that is opaque.
        opaque: HalfName,
    },
}

/// The hole of an aperture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Hole", deny_unknown_fields)]
#[schemars(transform = told("a hole", "Disc(center: (0, 0), radius: 0.1)"))]
pub enum HoleFile {
    /// A disc.
    Disc {
        /// Centre along X and Y.
        #[schemars(transform = told("a place along X and Y, in metres", "(0.1, 0.2)"), transform = any)]
        center: [f64; 2],
        /// Radius.
        #[schemars(transform = length)]
        radius: f64,
    },
    /// A rectangle with edges along X and Y.
    Rectangle {
        /// Centre along X and Y.
        #[schemars(transform = told("a place along X and Y, in metres", "(0.1, 0.2)"), transform = any)]
        center: [f64; 2],
        /// Side lengths along X and Y.
        #[schemars(transform = sides)]
        size: [f64; 2],
    },
    /// A convex polygon.
    Polygon {
        /// The 3 to 32 corners along X and Y, in order around the polygon.
        #[schemars(transform = told("places along X and Y, in metres", "[(0.1, 0), (-0.1, 0.1), (-0.1, -0.1)]"), transform = any)]
        corners: Vec<[f64; 2]>,
    },
}

/// A side of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = told("a side, Below or Above", "Below"))]
pub enum HalfName {
    /// Coordinates below the edge.
    Below,
    /// Coordinates above the edge.
    Above,
}
