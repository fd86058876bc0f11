//! Meshes with normals and texture coordinates.

use super::attribute::MeshAttribute;
use super::extension::by_extension;
use super::shared::check_coordinate;
use super::{obj, ply};
use etendue_scenefile::Fault;
use glam::{DVec2, DVec3};
use std::path::Path;

/// The triangles of a mesh file, with the normals and texture coordinates of their vertices.
///
/// All corners are valid indices of vertices, the numbers of normals and of texture coordinates
/// equal the number of vertices, and all numbers are finite. Triangles of zero area are kept. If
/// corners at the same position have different normals or texture coordinates, they are separate
/// vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct DetailedMesh {
    /// Positions, within ±10⁹.
    pub vertices: Vec<DVec3>,
    /// The indices of the three vertices of each triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Normals as in the file, of any length; zero at vertices without a normal.
    pub normals: Option<Vec<DVec3>>,
    /// Texture coordinates as in the file; zero at vertices without texture coordinates.
    pub uvs: Option<Vec<DVec2>>,
    /// The attributes that were wanted and found.
    pub attributes: Vec<MeshAttribute>,
    /// The names of all attributes of the file.
    pub attribute_names: Vec<String>,
}

impl DetailedMesh {
    /// Reads the bytes of an OBJ or a PLY file as [`Mesh::parse`](super::Mesh::parse) does, but
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
        by_extension(file, bytes, obj::detailed::read, |bytes| {
            ply::detailed::read(bytes, true, wanted)
        })
    }
}

/// Checks that numbers are within the range of coordinates.
pub(super) fn check<const N: usize>(
    values: [f64; N],
    place: impl Fn(usize) -> String,
) -> Result<[f64; N], Fault> {
    for (i, value) in values.into_iter().enumerate() {
        check_coordinate(value, || place(i))?;
    }
    Ok(values)
}
