//! Meshes with normals and texture coordinates.

use super::attribute::MeshAttribute;
use glam::{DVec2, DVec3};

/// The triangles of a mesh file, with the normals and texture coordinates of their vertices.
///
/// All corners are valid indices of vertices, the numbers of normals and of texture coordinates
/// equal the number of vertices, and all numbers are finite. Triangles of zero area are kept. If
/// corners at the same position have different normals or texture coordinates, they are separate
/// vertices.
#[derive(Clone, Debug, PartialEq)]
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
