//! Surface materials, finished or in progress.

use ::gltf::json::Material as BufferSource;
use etendue_world::EmittedRadiance;
use std::collections::BTreeSet;

/// The material of a surface.
#[derive(Clone, Debug)]
pub(super) struct GltfSurface {
    /// The index of the material.
    pub(super) material: usize,
    pub(super) emission: Option<EmittedRadiance>,
    pub(super) is_double_sided: bool,
    /// The texture coordinate set that the pictures use.
    pub(super) set: Option<u32>,
}

/// A material in progress.
pub(super) struct Draft<'a> {
    pub(super) source: &'a BufferSource,
    pub(super) path: String,
    /// Texture coordinate sets that pictures use.
    pub(super) sets: BTreeSet<u32>,
}
