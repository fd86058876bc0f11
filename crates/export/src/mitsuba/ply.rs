//! Meshes as binary PLY files (Turk 1994).

use super::patch::PatchMesh;
use glam::DVec3;
use std::collections::HashMap;

/// A mesh; corners with the same coordinates become one vertex.
pub(super) fn ply(triangles: &[[DVec3; 3]]) -> Vec<u8> {
    let corners = triangles.iter().map(|t| t.map(|p| p.to_array()));
    let (vertices, faces) = indexed(corners);
    written(&["x", "y", "z"], &vertices, &faces)
}

/// A mesh with normals at the corners of its triangles; corners with the same coordinates
/// and normal become one vertex.
pub(super) fn shaded(triangles: &[[DVec3; 3]], normals: &[[DVec3; 3]]) -> Vec<u8> {
    let corners = triangles.iter().zip(normals).map(|(points, normals)| {
        [0, 1, 2].map(|i| {
            let (p, n) = (points[i], normals[i]);
            [p.x, p.y, p.z, n.x, n.y, n.z]
        })
    });
    let (vertices, faces) = indexed(corners);
    written(&["x", "y", "z", "nx", "ny", "nz"], &vertices, &faces)
}

/// A mesh with normals and texture coordinates.
pub(super) fn smooth(mesh: &PatchMesh) -> Vec<u8> {
    let vertices: Vec<[f64; 8]> = mesh
        .vertices
        .iter()
        .map(|v| {
            let (p, n, uv) = (v.point, v.normal, v.uv);
            [p.x, p.y, p.z, n.x, n.y, n.z, uv.x, uv.y]
        })
        .collect();
    let names = ["x", "y", "z", "nx", "ny", "nz", "u", "v"];
    written(&names, &vertices, &mesh.faces)
}

fn written<const N: usize>(
    names: &[&str; N],
    vertices: &[[f64; N]],
    faces: &[[u32; 3]],
) -> Vec<u8> {
    let properties = names
        .map(|name| format!("property double {name}\n"))
        .concat();
    let header = format!(
        "ply\nformat binary_little_endian 1.0\n\
         element vertex {}\n{properties}\
         element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        vertices.len(),
        faces.len()
    );
    let mut bytes = header.into_bytes();
    for vertex in vertices {
        bytes.extend(vertex.map(f64::to_le_bytes).as_flattened());
    }
    for face in faces {
        bytes.push(3);
        bytes.extend(face.map(u32::to_le_bytes).as_flattened());
    }
    bytes
}

/// The vertices in order of first use, and the triangles as indices of vertices.
fn indexed<const N: usize>(
    triangles: impl Iterator<Item = [[f64; N]; 3]>,
) -> (Vec<[f64; N]>, Vec<[u32; 3]>) {
    let (mut vertices, mut next) = (Vec::new(), 0);
    let mut numbers = HashMap::new();
    let mut number = |corner: [f64; N]| {
        let bits = corner.map(f64::to_bits);
        *numbers.entry(bits).or_insert_with(|| {
            vertices.push(corner);
            next += 1;
            next - 1
        })
    };
    let faces = triangles.map(|t| t.map(&mut number)).collect();
    (vertices, faces)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shared_corners_are_written_once_and_every_bit_is_kept() {
        let [a, b, c, d] = [0.1, 1.0 / 3.0, 1e-9, -2.5e7].map(|t| DVec3::new(t, 1.0 - t, 0.2 * t));
        let bytes = ply(&[[a, b, c], [c, b, d]]);
        let mark: &[u8] = b"end_header\n";
        let start = bytes.windows(mark.len()).position(|w| w == mark).unwrap() + mark.len();
        let (vertices, faces) = bytes[start..].split_at(4 * 24);
        let numbers = vertices
            .chunks(8)
            .map(|n| f64::from_le_bytes(n.try_into().unwrap()));
        let written = [a, b, c, d].map(|p| p.to_array());
        assert_eq!(numbers.collect::<Vec<f64>>(), written.as_flattened());
        let face = |n: [u8; 3]| [3, n[0], 0, 0, 0, n[1], 0, 0, 0, n[2], 0, 0, 0];
        assert_eq!(faces, [face([0, 1, 2]), face([2, 1, 3])].as_flattened());
    }
}
