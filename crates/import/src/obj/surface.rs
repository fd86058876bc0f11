//! What a part is made of.

use etendue_world::Texture;

/// What a part is made of.
#[derive(Clone, Debug)]
pub(super) struct ObjSurface {
    pub(super) material: usize,
    pub(super) emission: Option<Texture>,
    /// A picture that needs texture coordinates.
    pub(super) has_picture: bool,
}
