//! What tells meshes and textures apart that are made once.

use std::path::PathBuf;

/// How (u, v) of a world's surface go with those of pbrt.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Uv {
    /// They are the same.
    Own,
    /// On spheres pbrt's v goes up from the lower pole.
    Ball,
    /// On discs pbrt's u is the azimuth, and v goes in from the edge.
    Disc,
}

/// The file of a mesh, and whether its texture coordinates are asked for.
pub(super) type PbrtMeshKey = (PathBuf, bool);

/// A texture once read, by its name and what it is asked for.
pub(super) type TextureKey = (bool, String, u8, Uv);
