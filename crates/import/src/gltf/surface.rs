//! What surfaces are made of, read and while they are read.

use ::gltf::json::Material as BufferSource;
use etendue_world::EmittedRadiance;
use std::collections::BTreeSet;

/// What a surface is made of.
#[derive(Clone, Debug)]
pub(super) struct GltfSurface {
    /// The number of its material.
    pub(super) material: usize,
    pub(super) emission: Option<EmittedRadiance>,
    pub(super) is_double_sided: bool,
    /// The texture coordinates that its pictures go by.
    pub(super) set: Option<u32>,
}

/// A material while it is read.
pub(super) struct Draft<'a> {
    pub(super) source: &'a BufferSource,
    pub(super) path: String,
    /// Texture coordinates that pictures ask for.
    pub(super) sets: BTreeSet<u32>,
}
