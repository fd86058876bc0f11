//! Reads meshes from files and writes them to files.

use super::extension::by_extension;
use super::shared::Mesh;
use super::{obj, ply};
use etendue_scenefile::Fault;
use std::path::Path;

impl Mesh {
    /// Reads the bytes of an OBJ or a PLY file. The extension of `file`, in any case, determines
    /// the format.
    ///
    /// In OBJ files, the `v` and `f` lines of all objects and groups form one mesh. Normals,
    /// texture coordinates, colors, weights, materials, points and lines are ignored, and
    /// free-form surfaces are refused. PLY files may be ASCII or binary in either byte order, with
    /// coordinates and lists of any type. Their other elements and properties are ignored. Faces
    /// of more than three corners become fans about their first corner, which is right for convex
    /// faces, and have at most 4,096 corners. Triangles of zero area are dropped where others
    /// remain.
    ///
    /// # Errors
    /// The first fault found, with its place in the file, the value and what is allowed. Elements
    /// are counted as in the format, from 1 in OBJ and from 0 in PLY files; lines and corners are
    /// counted from 1.
    pub fn parse(file: &Path, bytes: &[u8]) -> Result<Self, Fault> {
        by_extension(file, bytes, obj::read, |bytes| {
            let mesh = ply::detailed::read(bytes, false)?;
            Self::new(mesh.vertices, mesh.triangles)
        })
    }

    /// Returns the mesh as a binary little-endian PLY file, exact: coordinates as `double`, indices
    /// as `uint`.
    #[must_use]
    pub fn ply(&self) -> Vec<u8> {
        ply::write(&self.vertices, &self.triangles)
    }
}
