//! PLY files (Turk, The PLY Polygon File Format, 1994): vertices and faces, with normals, texture
//! coordinates and attributes.

mod attributes;
mod body;
mod header;

use crate::detailed::DetailedMesh;
use crate::fault::{Fault, fault};
use crate::mesh::{AXES, check_coordinates, check_corners, fan};
use attributes::AttributeReader;
use body::{Body, PlyRow, whole};
use glam::DVec3;
use header::{PlyElement, PlyHeader};

/// Property names of texture coordinates.
const UVS: [[&str; 2]; 3] = [["u", "v"], ["s", "t"], ["texture_u", "texture_v"]];

/// Reads the vertices and faces of a PLY file; with `has_shading`, also reads normals and texture
/// coordinates. Also reads the wanted attributes.
pub(crate) fn read(
    bytes: &[u8],
    has_shading: bool,
    wanted: &[String],
) -> Result<DetailedMesh, Fault> {
    let (header, data) = PlyHeader::read(bytes)?;
    let element = header.element("vertex")?;
    let axes = axes(element)?;
    let normal = element.columns(["nx", "ny", "nz"]).filter(|_| has_shading);
    let uv = UVS
        .iter()
        .find_map(|names| element.columns(*names))
        .filter(|_| has_shading);
    let list = list(header.element("face")?)?;
    let mut of_vertices = AttributeReader::new(element, "vertex_", wanted);
    let mut of_faces = AttributeReader::new(header.element("face")?, "face_", wanted);
    let count = element.count;
    let mut mesh = DetailedMesh {
        normals: normal.map(|_| Vec::new()),
        uvs: uv.map(|_| Vec::new()),
        ..DetailedMesh::default()
    };
    let mut corners = Vec::new();
    let mut body = Body::new(data, header.encoding);
    for element in &header.elements {
        body.rows(element, |row, values| {
            match element.name.as_str() {
                "vertex" => {
                    let vertex = numbers(row, values, axes, AXES)?;
                    mesh.vertices.push(vertex.into());
                    if let Some((normals, columns)) = mesh.normals.as_mut().zip(normal) {
                        normals.push(numbers(row, values, columns, ["nx", "ny", "nz"])?.into());
                    }
                    if let Some((uvs, columns)) = mesh.uvs.as_mut().zip(uv) {
                        uvs.push(numbers(row, values, columns, ["u", "v"])?.into());
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

/// The positions of x, y and z among the properties of a PLY vertex.
fn axes(element: &PlyElement) -> Result<[usize; 3], Fault> {
    let mut axes = [0; 3];
    for (axis, name) in axes.iter_mut().zip(AXES) {
        *axis = element.column(name).ok_or_else(|| {
            let place = format!("property {name} of element vertex");
            fault(place, "missing", "property float x, y and z")
        })?;
    }
    if element.count == 0 {
        return Err(fault("vertices", 0, "at least 3"));
    }
    Ok(axes)
}

/// The position of the list of corners among the properties of a PLY face.
fn list(element: &PlyElement) -> Result<usize, Fault> {
    let names = ["vertex_indices", "vertex_index"];
    let mut properties = element.properties.iter();
    let position = properties.position(|p| {
        names.contains(&p.name.as_str()) && p.length.is_some() && !p.scalar.is_float()
    });
    let found = position.ok_or_else(|| {
        let place = "property vertex_indices of element face";
        fault(place, "missing", "property list uchar int vertex_indices")
    })?;
    if element.count == 0 {
        return Err(fault("faces", 0, "at least 1"));
    }
    Ok(found)
}

/// The numbers in some columns of a row, which are within the range of coordinates.
fn numbers<const N: usize>(
    row: PlyRow<'_>,
    values: &[Vec<f64>],
    columns: [usize; N],
    names: [&str; N],
) -> Result<[f64; N], Fault> {
    check_coordinates(columns.map(|column| values[column][0]), |i| {
        row.place(names[i])
    })
}

/// Appends the triangles of a face, whose corners must be indices below `count`, the number of
/// vertices.
fn face(
    row: PlyRow<'_>,
    values: &[f64],
    count: usize,
    corners: &mut Vec<u32>,
) -> Result<(), Fault> {
    check_corners(values.len(), || row.place("number of corners"))?;
    corners.clear();
    for (i, value) in values.iter().enumerate() {
        let index = whole(*value).filter(|index| (*index as usize) < count);
        corners.push(index.ok_or_else(|| {
            let place = row.place(&format!("corner {}", i + 1));
            fault(place, value, format!("0 to {}", count - 1))
        })?);
    }
    Ok(())
}

pub(crate) fn write(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Vec<u8> {
    let mut file = format!(
        "ply\nformat binary_little_endian 1.0\n\
         element vertex {}\nproperty double x\nproperty double y\nproperty double z\n\
         element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        vertices.len(),
        triangles.len()
    )
    .into_bytes();
    file.reserve(24 * vertices.len() + 13 * triangles.len());
    for value in vertices.iter().flat_map(DVec3::to_array) {
        file.extend(value.to_le_bytes());
    }
    for corners in triangles {
        file.push(3);
        file.extend(corners.iter().flat_map(|corner| corner.to_le_bytes()));
    }
    file
}
