//! Keys of meshes in a cache, so that each mesh is read only once.

use std::path::PathBuf;
use std::rc::Rc;

/// The source and the options of a mesh; shapes with equal keys share the mesh.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct MitsubaMeshKey {
    pub(super) path: PathBuf,
    pub(super) number: u32,
    pub(super) is_flat: bool,
    pub(super) is_flipped: bool,
    /// The names of the attributes to read.
    pub(super) attributes: Rc<[String]>,
    /// The linear part of the placement, on which smooth normals depend.
    pub(super) linear: Option<[u64; 9]>,
}
