//! Keys of meshes and textures in a cache, so that each mesh and each texture is made only once.

use std::path::PathBuf;

/// The relation between the (u, v) of a surface in pbrt and its (u, v) in a world.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Uv {
    /// Both are equal.
    Own,
    /// On spheres pbrt's v increases from the lower pole upwards.
    Ball,
    /// On discs pbrt's u is the azimuth, and v increases from the edge inwards.
    Disc,
}

/// The key of a mesh: the file of the mesh, and whether the mesh needs texture coordinates.
pub(super) type PbrtMeshKey = (PathBuf, bool);

/// The key of a texture. It consists of the texture's name, the type of its values, and the
/// coordinates of its surface.
pub(super) type TextureKey = (bool, String, u8, Uv);
