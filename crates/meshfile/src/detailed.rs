//! Meshes with normals, texture coordinates and attributes.

use glam::{DVec2, DVec3};

/// The triangles of a mesh file, with the normals and texture coordinates of their vertices.
///
/// All corners are valid indices of vertices, the numbers of normals and of texture coordinates
/// equal the number of vertices, and all numbers are finite. Triangles of zero area are kept. If
/// corners at the same position have different normals or texture coordinates, they are separate
/// vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DetailedMesh {
    /// Positions, within ±10⁹.
    pub vertices: Vec<DVec3>,
    /// The indices of the three vertices of each triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Normals as in the file, of any length; zero at vertices without a normal.
    pub normals: Option<Vec<DVec3>>,
    /// Texture coordinates as in the file; zero at vertices without texture coordinates.
    pub uvs: Option<Vec<DVec2>>,
    /// The attributes that were wanted and found.
    pub attributes: Vec<MeshAttribute>,
    /// The names of all attributes of the file.
    pub attribute_names: Vec<String>,
}

/// Numbers of a mesh file that belong to its vertices or to its triangles, such as colours.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshAttribute {
    /// The name, which begins with `vertex_` or `face_`.
    pub name: String,
    /// How many numbers a vertex or a triangle has: 1 to 4.
    pub channels: usize,
    /// The numbers of the first vertex or triangle, then those of the second, and so on. They are
    /// within ±10⁹.
    pub values: Vec<f64>,
    /// Whether the numbers belong to vertices, not to triangles.
    pub is_of_vertices: bool,
}
