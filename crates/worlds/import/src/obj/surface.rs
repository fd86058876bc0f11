//! The surface of a part.

use etendue_world::Texture;

/// The surface of a part.
#[derive(Clone, Debug)]
pub(super) struct ObjSurface {
    pub(super) material: usize,
    pub(super) emission: Option<Texture>,
    /// Whether the surface has a picture, which needs texture coordinates.
    pub(super) has_picture: bool,
}
