//! Triangles with shared vertices, and what a mesh may hold.

use etendue_scenefile::limits::MAX_NUMBER;
use etendue_scenefile::{Fault, fault};
use glam::{DAffine3, DVec3};

/// Triangles with shared vertices, in the file's units and frame.
///
/// Valid by construction: at least one triangle, each with an area and with corners among the vertices;
/// coordinates within ±10⁹. Corners run counterclockwise seen from outside, where the file says so; nothing
/// here asks for a closed surface. Vertices that no triangle uses may be there.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    pub(super) vertices: Vec<DVec3>,
    pub(super) triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// The mesh of these triangles, less those of zero area (in f64), of which real files hold a few. What a scene drops or refuses beside
    /// these depends on where it places them.
    ///
    /// # Errors
    /// A coordinate or an index out of range, or no triangle with an area.
    pub fn new(vertices: Vec<DVec3>, mut triangles: Vec<[u32; 3]>) -> Result<Self, Fault> {
        // One index is kept free, so that the number of vertices is a u32 too.
        let count = u32::try_from(vertices.len())
            .map_err(|_| fault("vertices", vertices.len(), format!("at most {}", u32::MAX)))?;
        for (i, vertex) in vertices.iter().enumerate() {
            for (axis, value) in ["x", "y", "z"].into_iter().zip(vertex.to_array()) {
                check_coordinate(value, || format!("vertex {i}, {axis}"))?;
            }
        }
        for (i, corners) in triangles.iter().enumerate() {
            if let Some(corner) = corners.iter().find(|corner| **corner >= count) {
                let allowed = format!("indices of the {count} vertices, from 0");
                return Err(fault(format!("triangle {i}, a corner"), corner, allowed));
            }
        }
        triangles.retain(|corners| has_area(&vertices, *corners));
        if triangles.is_empty() {
            return Err(fault("triangles with an area", 0, "at least 1"));
        }
        Ok(Self {
            vertices,
            triangles,
        })
    }

    /// The mesh under an affine map; a map that mirrors also turns the corners' order, so that outside stays
    /// outside.
    ///
    /// # Errors
    /// Coordinates beyond ±10⁹, or a map that leaves no triangle an area.
    pub fn transformed(&self, map: DAffine3) -> Result<Self, Fault> {
        let vertices = self.vertices.iter().map(|v| map.transform_point3(*v));
        let mirrored = map.matrix3.determinant() < 0.0;
        let turn = |[a, b, c]: [u32; 3]| if mirrored { [a, c, b] } else { [a, b, c] };
        let triangles = self.triangles.iter().copied().map(turn);
        Self::new(vertices.collect(), triangles.collect())
    }

    /// Vertices; triangles name them by index.
    #[must_use]
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// Corners of each triangle, as indices of [`Mesh::vertices`].
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Corner points of one triangle after the other.
    pub fn corners(&self) -> impl ExactSizeIterator<Item = [DVec3; 3]> {
        let point = |i: u32| self.vertices[i as usize];
        self.triangles.iter().map(move |corners| corners.map(point))
    }

    /// Lowest and highest coordinates of the triangles.
    #[must_use]
    pub fn bounds(&self) -> [DVec3; 2] {
        let nothing = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        self.corners()
            .flatten()
            .fold(nothing, |[low, high], p| [low.min(p), high.max(p)])
    }
}

/// Whether the triangle's area, in f64, is more than zero.
fn has_area(vertices: &[DVec3], corners: [u32; 3]) -> bool {
    let [a, b, c] = corners.map(|i| vertices[i as usize]);
    (b - a).cross(c - a) != DVec3::ZERO
}

/// Corners of a face. All triangles of a fan have its first corner, so a ray near it meets the boxes of most of them.
const MAX_CORNERS: usize = 4096;

/// Requires a number of corners that a face may have.
pub(super) fn check_corners(count: usize, place: impl FnOnce() -> String) -> Result<(), Fault> {
    match (3..=MAX_CORNERS).contains(&count) {
        true => Ok(()),
        false => Err(fault(place(), count, format!("3 to {MAX_CORNERS}"))),
    }
}

/// Requires a coordinate that a scene may hold.
pub(super) fn check_coordinate(value: f64, place: impl FnOnce() -> String) -> Result<f64, Fault> {
    if value.abs() <= MAX_NUMBER {
        Ok(value)
    } else {
        let allowed = format!("{:?} to {MAX_NUMBER:?}", -MAX_NUMBER);
        Err(fault(place(), format!("{value:?}"), allowed))
    }
}

/// Triangles of a face: the fan about its first corner.
pub(super) fn fan(corners: &[u32]) -> impl Iterator<Item = [u32; 3]> {
    let pairs = corners.get(1..).unwrap_or_default().windows(2);
    pairs.map(|pair| [corners[0], pair[0], pair[1]])
}
