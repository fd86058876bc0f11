//! Reads meshes from files and writes them to files.

use crate::detailed::DetailedMesh;
use crate::fault::{Fault, fault};
use crate::mesh::Mesh;
use crate::{obj, ply, text};
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
            let mesh = ply::read(bytes, false, &[])?;
            Self::new(mesh.vertices, mesh.triangles)
        })
    }

    /// The mesh as a binary little-endian PLY file. Coordinates are written as `double` and
    /// indices as `uint`, so no digits are lost.
    #[must_use]
    pub fn ply(&self) -> Vec<u8> {
        ply::write(&self.vertices, &self.triangles)
    }
}

impl DetailedMesh {
    /// Reads the bytes of an OBJ or a PLY file as [`Mesh::parse`] does, but
    /// with normals and texture coordinates. Normals are `vn` in OBJ files, and nx, ny and nz in
    /// PLY files. Texture coordinates are `vt` in OBJ files. In PLY files, texture coordinates are
    /// u and v, s and t, or `texture_u` and `texture_v`.
    ///
    /// # Errors
    /// The first fault found.
    pub fn parse(file: &Path, bytes: &[u8]) -> Result<Self, Fault> {
        Self::parse_with(file, bytes, &[])
    }

    /// Reads a mesh as [`Self::parse`] does, and also the wanted attributes of a PLY file. They have
    /// the names that Mitsuba gives them: the properties red, green and blue (or r, g and b) of a
    /// vertex are `vertex_color`, and `weight_0` of a face is `face_weight`. A face of more than
    /// three corners gives its numbers to all its triangles.
    ///
    /// # Errors
    /// The first fault found. An attribute that is missing is not a fault.
    pub fn parse_with(file: &Path, bytes: &[u8], wanted: &[String]) -> Result<Self, Fault> {
        by_extension(file, bytes, obj::read_detailed, |bytes| {
            ply::read(bytes, true, wanted)
        })
    }
}

/// Reads bytes in the format to which the extension of `file` belongs.
fn by_extension<T>(
    file: &Path,
    bytes: &[u8],
    obj: fn(&[u8]) -> Result<T, Fault>,
    ply: impl FnOnce(&[u8]) -> Result<T, Fault>,
) -> Result<T, Fault> {
    let extension = file.extension().unwrap_or_default().to_string_lossy();
    match extension.to_ascii_lowercase().as_str() {
        "obj" | "ply" if bytes.is_empty() => Err(fault("the file", "empty", "a mesh")),
        "obj" => obj(bytes),
        "ply" => ply(bytes),
        _ => Err(fault(
            "the extension",
            text::quoted(extension.as_bytes()),
            "obj, ply",
        )),
    }
}
