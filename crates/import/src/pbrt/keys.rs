//! Keys of meshes and textures that are made once.

use std::path::PathBuf;

/// The relation between (u, v) of a surface in a world and in pbrt.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Uv {
    /// Both are equal.
    Own,
    /// On spheres pbrt's v increases from the lower pole upwards.
    Ball,
    /// On discs pbrt's u is the azimuth, and v increases from the edge inwards.
    Disc,
}

/// The file of a mesh, and whether its texture coordinates are needed.
pub(super) type PbrtMeshKey = (PathBuf, bool);

/// The key of a texture: its name, and the type and coordinates it is read for.
pub(super) type TextureKey = (bool, String, u8, Uv);
