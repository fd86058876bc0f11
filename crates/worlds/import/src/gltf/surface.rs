//! Materials of surfaces: finished materials, and materials that are being converted.

use ::gltf::json::Material as BufferSource;
use etendue_world::EmittedRadiance;
use std::collections::BTreeSet;

/// The material of a surface.
#[derive(Clone, Debug)]
pub(super) struct GltfSurface {
    /// The index of the material in the world.
    pub(super) material: usize,
    pub(super) emission: Option<EmittedRadiance>,
    pub(super) is_double_sided: bool,
    /// The number of the set of texture coordinates that the pictures use.
    pub(super) set: Option<u32>,
}

/// A material that is being converted.
pub(super) struct Draft<'a> {
    pub(super) source: &'a BufferSource,
    pub(super) path: String,
    /// The sets of texture coordinates that the pictures converted so far use.
    pub(super) sets: BTreeSet<u32>,
}
