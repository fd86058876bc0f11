//! Meshes of triangles.

use glam::{DVec2, DVec3};

/// Triangles with shared vertices.
///
/// Corners are counterclockwise as seen from the front. The constructor ensures that corners refer
/// to vertices. If there are normals or texture coordinates, it also ensures that their number is
/// the number of vertices.
#[derive(Clone, Debug)]
pub struct Triangles {
    vertices: Vec<DVec3>,
    corners: Vec<[u32; 3]>,
    normals: Option<Vec<DVec3>>,
    uvs: Option<Vec<DVec2>>,
}

impl Triangles {
    /// Returns `None` if a corner does not refer to a vertex, or if lengths disagree. Normals may
    /// have any length except zero. If there are no normals, triangles are flat.
    #[must_use]
    pub fn new(
        vertices: Vec<DVec3>,
        corners: Vec<[u32; 3]>,
        normals: Option<Vec<DVec3>>,
        uvs: Option<Vec<DVec2>>,
    ) -> Option<Self> {
        let count = vertices.len();
        let agrees = |length: Option<usize>| length.is_none_or(|length| length == count);
        let fits = agrees(normals.as_ref().map(Vec::len)) && agrees(uvs.as_ref().map(Vec::len));
        let within = corners
            .iter()
            .flatten()
            .all(|corner| (*corner as usize) < count);
        (fits && within).then_some(Self {
            vertices,
            corners,
            normals,
            uvs,
        })
    }

    /// Positions of the vertices.
    #[inline]
    #[must_use]
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// The vertices of each triangle.
    #[inline]
    #[must_use]
    pub fn corners(&self) -> &[[u32; 3]] {
        &self.corners
    }

    /// Shading normals at the vertices.
    #[inline]
    #[must_use]
    pub fn normals(&self) -> Option<&[DVec3]> {
        self.normals.as_deref()
    }

    /// Texture coordinates of the vertices.
    #[inline]
    #[must_use]
    pub fn uvs(&self) -> Option<&[DVec2]> {
        self.uvs.as_deref()
    }
}
