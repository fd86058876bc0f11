//! Reads meshes from files and writes them to files.

use super::extension::by_extension;
use super::shared::Mesh;
use super::{obj, ply};
use etendue_scenefile::Fault;
use std::path::Path;

impl Mesh {
    /// Reads the bytes of an OBJ or a PLY file. The extension of `file`, in upper or lower case,
    /// determines the format.
    ///
    /// In OBJ files, the `v` and `f` lines of all objects and groups form one mesh. Normals,
    /// texture coordinates, colors, weights, materials, points and lines are ignored, and free-form
    /// surfaces are refused. PLY files may be ASCII or binary in either byte order, with
    /// coordinates and lists of any type. The readers ignore all elements and properties of PLY
    /// files except vertices with their coordinates and faces with their corners. A face of more
    /// than three corners becomes a fan of triangles about its first corner, which is correct for
    /// convex faces. A face has at most 4,096 corners. Triangles of zero area are dropped if other
    /// triangles remain.
    ///
    /// # Errors
    /// The first fault that is found. The fault states its position in the file, the faulty value
    /// and the values that are allowed. Elements are counted from 1 in OBJ files and from 0 in PLY
    /// files, as these formats do. Lines and corners are always counted from 1.
    pub fn parse(file: &Path, bytes: &[u8]) -> Result<Self, Fault> {
        by_extension(file, bytes, obj::read, |bytes| {
            let mesh = ply::detailed::read(bytes, false, &[])?;
            Self::new(mesh.vertices, mesh.triangles)
        })
    }

    /// Returns the mesh as a binary little-endian PLY file. Coordinates are written as `double` and
    /// indices as `uint`, so no digits are lost.
    #[must_use]
    pub fn ply(&self) -> Vec<u8> {
        ply::write(&self.vertices, &self.triangles)
    }
}
