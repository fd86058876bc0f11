//! Attributes of meshes.

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
