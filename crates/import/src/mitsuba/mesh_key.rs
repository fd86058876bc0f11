//! What tells meshes apart that are read once.

use std::path::PathBuf;

/// What a mesh is read from and how, so that shapes may share it.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct MitsubaMeshKey {
    pub(super) path: PathBuf,
    pub(super) number: u32,
    pub(super) is_flat: bool,
    pub(super) is_flipped: bool,
    /// Smooth normals are made for the shape as placed.
    pub(super) linear: Option<[u64; 9]>,
}
