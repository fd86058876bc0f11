//! PLY files (Turk, The PLY Polygon File Format, 1994): vertices and faces.

mod attributes;
mod body;
pub(super) mod detailed;
mod header;

use super::shared::{check_coordinate, check_corners};
use body::PlyRow;
use etendue_scenefile::{Fault, fault};
use glam::DVec3;
use header::PlyElement;

/// Returns the positions of x, y and z among the properties of a PLY vertex.
fn axes(element: &PlyElement) -> Result<[usize; 3], Fault> {
    let mut axes = [0; 3];
    for (axis, name) in axes.iter_mut().zip(["x", "y", "z"]) {
        *axis = element
            .properties
            .iter()
            .position(|p| p.name == name && p.length.is_none())
            .ok_or_else(|| {
                let place = format!("property {name} of element vertex");
                fault(place, "missing", "property float x, y and z")
            })?;
    }
    if element.count == 0 {
        return Err(fault("vertices", 0, "at least 3"));
    }
    Ok(axes)
}

/// Returns the position of the list of corners among the properties of a PLY face.
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

/// Returns the positions of the properties with the given names; `None` unless all of these
/// properties are present as single numbers.
fn columns<const N: usize>(element: &PlyElement, names: [&str; N]) -> Option<[usize; N]> {
    let found = names.map(|name| {
        let mut properties = element.properties.iter();
        properties.position(|p| p.name == name && p.length.is_none())
    });
    found
        .iter()
        .all(Option::is_some)
        .then(|| found.map(Option::unwrap_or_default))
}

fn vertex(row: PlyRow<'_>, values: [f64; 3]) -> Result<DVec3, Fault> {
    for (axis, value) in ["x", "y", "z"].into_iter().zip(values) {
        check_coordinate(value, || row.place(axis))?;
    }
    Ok(DVec3::from_array(values))
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
        let index = body::whole(*value).filter(|index| (*index as usize) < count);
        corners.push(index.ok_or_else(|| {
            let place = row.place(&format!("corner {}", i + 1));
            fault(place, value, format!("0 to {}", count - 1))
        })?);
    }
    Ok(())
}

pub(super) fn write(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Vec<u8> {
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
