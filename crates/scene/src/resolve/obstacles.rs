//! Defines the set of objects that the central ray may meet.

use crate::scene::{BlockerLayer, MeshObject, PatchObject, Surface};

/// The objects that the central ray may meet.
#[derive(Clone, Copy)]
pub(super) struct Things<'a> {
    pub(super) blockers: &'a [BlockerLayer],
    pub(super) surfaces: &'a [Surface],
    pub(super) meshes: &'a [MeshObject],
    pub(super) patches: &'a [PatchObject],
}
