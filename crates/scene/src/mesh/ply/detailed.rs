//! Reads PLY files with the normals and texture coordinates of their vertices.

use super::super::detailed::DetailedMesh;
use super::super::shared::{check_coordinates, fan};
use super::attributes::AttributeReader;
use super::body::Body;
use super::header::PlyHeader;
use super::{axes, columns, face, list, vertex};
use etendue_scenefile::Fault;
use glam::{DVec2, DVec3};

/// Property names of texture coordinates.
const UVS: [[&str; 2]; 3] = [["u", "v"], ["s", "t"], ["texture_u", "texture_v"]];

/// Reads the vertices and faces of a PLY file; with `has_shading`, also reads normals and texture
/// coordinates. Also reads the wanted attributes.
pub(in super::super) fn read(
    bytes: &[u8],
    has_shading: bool,
    wanted: &[String],
) -> Result<DetailedMesh, Fault> {
    let (header, data) = PlyHeader::read(bytes)?;
    let element = header.element("vertex")?;
    let axes = axes(element)?;
    let normal = columns(element, ["nx", "ny", "nz"]).filter(|_| has_shading);
    let uv = UVS.iter().find_map(|names| columns(element, *names));
    let uv = uv.filter(|_| has_shading);
    let list = list(header.element("face")?)?;
    let mut of_vertices = AttributeReader::new(element, "vertex_", wanted);
    let mut of_faces = AttributeReader::new(header.element("face")?, "face_", wanted);
    let count = element.count;
    let mut mesh = DetailedMesh {
        vertices: Vec::new(),
        triangles: Vec::new(),
        normals: normal.map(|_| Vec::new()),
        uvs: uv.map(|_| Vec::new()),
        attributes: Vec::new(),
        attribute_names: Vec::new(),
    };
    let mut corners = Vec::new();
    let mut body = Body::new(data, header.encoding);
    for element in &header.elements {
        body.rows(element, |row, values| {
            match element.name.as_str() {
                "vertex" => {
                    mesh.vertices
                        .push(vertex(row, axes.map(|axis| values[axis][0]))?);
                    if let Some((normals, columns)) = mesh.normals.as_mut().zip(normal) {
                        let found = columns.map(|column| values[column][0]);
                        let place = |i: usize| row.place(["nx", "ny", "nz"][i]);
                        normals.push(DVec3::from(check_coordinates(found, place)?));
                    }
                    if let Some((uvs, columns)) = mesh.uvs.as_mut().zip(uv) {
                        let found = columns.map(|column| values[column][0]);
                        let place = |i: usize| row.place(["u", "v"][i]);
                        uvs.push(DVec2::from(check_coordinates(found, place)?));
                    }
                    of_vertices.push(row, values, 1)?;
                }
                "face" => {
                    face(row, &values[list], count, &mut corners)?;
                    let before = mesh.triangles.len();
                    mesh.triangles.extend(fan(&corners));
                    of_faces.push(row, values, mesh.triangles.len() - before)?;
                }
                _ => {}
            }
            Ok(())
        })?;
    }
    body.end()?;
    for reader in [of_vertices, of_faces] {
        mesh.attributes.extend(reader.read);
        mesh.attribute_names.extend(reader.names);
    }
    Ok(mesh)
}
