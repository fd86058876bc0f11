//! Mitsuba's cube from −1 to 1: twelve triangles, flat normals, and the whole texture on each side.

use crate::meshes::MeshParts;
use glam::{DVec2, DVec3};

/// The normal and corners of each side of the cube. Bit k of a corner is set if coordinate k of the
/// corner is 1.
const SIDES: [([f64; 3], [u32; 4]); 6] = [
    ([0.0, -1.0, 0.0], [1, 5, 4, 0]),
    ([0.0, 1.0, 0.0], [3, 2, 6, 7]),
    ([1.0, 0.0, 0.0], [1, 3, 7, 5]),
    ([0.0, 0.0, 1.0], [5, 7, 6, 4]),
    ([-1.0, 0.0, 0.0], [4, 6, 2, 0]),
    ([0.0, 0.0, -1.0], [3, 1, 0, 2]),
];

pub(super) fn parts() -> MeshParts {
    let (mut vertices, mut normals, mut uvs) = (Vec::new(), Vec::new(), Vec::new());
    let mut corners = Vec::new();
    for (side, (normal, places)) in (0_u32..).zip(SIDES) {
        let first = 4 * side;
        for place in places {
            let coordinate = |k: u32| if place >> k & 1 == 1 { 1.0 } else { -1.0 };
            vertices.push(DVec3::new(coordinate(0), coordinate(1), coordinate(2)));
            normals.push(DVec3::from(normal));
        }
        uvs.extend([[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]].map(DVec2::from));
        corners.push([first, first + 1, first + 2]);
        corners.push([first + 3, first, first + 2]);
    }
    MeshParts {
        vertices,
        corners,
        normals: Some(normals),
        uvs: Some(uvs),
    }
}
