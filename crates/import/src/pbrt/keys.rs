//! Keys of meshes and textures, by which each is made only once.

use std::path::PathBuf;

/// How (u, v) of a surface in pbrt follow from its (u, v) in a world.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Uv {
    /// Both are equal.
    Own,
    /// On spheres pbrt's v increases from the lower pole upwards.
    Ball,
    /// On discs pbrt's u is the azimuth, and v increases from the edge inwards.
    Disc,
}

/// The key of a mesh: its file, and whether its texture coordinates are needed.
pub(super) type PbrtMeshKey = (PathBuf, bool);

/// The key of a texture: its name, and for which type and which coordinates it is read.
pub(super) type TextureKey = (bool, String, u8, Uv);
