//! Points of surfaces, as textures see them.

use glam::DVec2;

/// A point of a surface, as textures see it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TexturePoint {
    /// Texture coordinates (u, v).
    pub uv: DVec2,
    /// On a mesh, the index of the triangle.
    pub triangle: usize,
    /// On a mesh, the weights of the triangle's second and third corners. The weight of the first
    /// corner is 1 minus their sum.
    pub weights: DVec2,
}

impl From<DVec2> for TexturePoint {
    /// A point with the given texture coordinates, which is not on a mesh.
    fn from(uv: DVec2) -> Self {
        Self {
            uv,
            ..Self::default()
        }
    }
}
