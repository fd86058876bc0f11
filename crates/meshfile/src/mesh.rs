//! Defines a mesh of triangles with shared vertices, and its limits.

use crate::fault::{Fault, fault};
use glam::{DAffine3, DVec3};

/// The names of the coordinates in messages.
pub(crate) const AXES: [&str; 3] = ["x", "y", "z"];
/// The largest coordinate, which is also the largest number of a scene.
const MAX_COORDINATE: f64 = 1e9;

/// Triangles with shared vertices, in the file's units and frame.
///
/// A `Mesh` is always valid: it has at least one triangle, each triangle has an area and valid
/// vertex indices, and coordinates are within ±10⁹. If the file lists corners counterclockwise as
/// seen from outside, the corners of the mesh also have this order. The surface need not be closed.
/// Unused vertices are allowed.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    pub(crate) vertices: Vec<DVec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// The mesh of the given triangles. Real files contain triangles whose area is zero in
    /// f64; these triangles are left out. A scene may drop or refuse further triangles, depending
    /// on where the scene places the mesh.
    ///
    /// # Errors
    /// When a coordinate or an index is out of range, or when no triangle has an area.
    pub fn new(vertices: Vec<DVec3>, mut triangles: Vec<[u32; 3]>) -> Result<Self, Fault> {
        // The largest index is never used, so the number of vertices also fits in a u32.
        let count = u32::try_from(vertices.len())
            .map_err(|_| fault("vertices", vertices.len(), format!("at most {}", u32::MAX)))?;
        for (i, vertex) in vertices.iter().enumerate() {
            check_coordinates(vertex.to_array(), |axis| {
                format!("vertex {i}, {}", AXES[axis])
            })?;
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

    /// The mesh under an affine map. If the map mirrors the mesh, the order of corners is
    /// reversed, so that triangles still face outward.
    ///
    /// # Errors
    /// When coordinates exceed ±10⁹, or when no triangle has an area after the map.
    pub fn transformed(&self, map: DAffine3) -> Result<Self, Fault> {
        let vertices = self.vertices.iter().map(|v| map.transform_point3(*v));
        let mirrored = map.matrix3.determinant() < 0.0;
        let turn = |[a, b, c]: [u32; 3]| if mirrored { [a, c, b] } else { [a, b, c] };
        let triangles = self.triangles.iter().copied().map(turn);
        Self::new(vertices.collect(), triangles.collect())
    }

    /// The vertices of the mesh, to which triangles refer by index.
    #[must_use]
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// The corners of each triangle, as indices into [`Mesh::vertices`].
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The three corner points of each triangle, triangle by triangle.
    pub fn corners(&self) -> impl ExactSizeIterator<Item = [DVec3; 3]> {
        let point = |i: u32| self.vertices[i as usize];
        self.triangles.iter().map(move |corners| corners.map(point))
    }

    /// The lowest and highest coordinates of the triangles.
    #[must_use]
    pub fn bounds(&self) -> [DVec3; 2] {
        let nothing = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        self.corners()
            .flatten()
            .fold(nothing, |[low, high], p| [low.min(p), high.max(p)])
    }
}

/// Checks whether the triangle's area, in f64, is more than zero.
fn has_area(vertices: &[DVec3], corners: [u32; 3]) -> bool {
    let [a, b, c] = corners.map(|i| vertices[i as usize]);
    (b - a).cross(c - a) != DVec3::ZERO
}

/// The maximum number of corners of a face. All triangles of a fan share the first corner of
/// their face, so a ray near this corner meets the bounding boxes of most of the triangles.
const MAX_CORNERS: usize = 4096;

/// Checks the number of corners of a face.
pub(crate) fn check_corners(count: usize, place: impl FnOnce() -> String) -> Result<(), Fault> {
    match (3..=MAX_CORNERS).contains(&count) {
        true => Ok(()),
        false => Err(fault(place(), count, format!("3 to {MAX_CORNERS}"))),
    }
}

/// Checks that a coordinate is within the range of coordinates.
pub(crate) fn check_coordinate(value: f64, place: impl FnOnce() -> String) -> Result<f64, Fault> {
    if value.abs() <= MAX_COORDINATE {
        Ok(value)
    } else {
        let allowed = format!("{:?} to {MAX_COORDINATE:?}", -MAX_COORDINATE);
        Err(fault(place(), format!("{value:?}"), allowed))
    }
}

/// The triangles of a face as a fan about the face's first corner.
pub(crate) fn fan(corners: &[u32]) -> impl Iterator<Item = [u32; 3]> {
    let pairs = corners.get(1..).unwrap_or_default().windows(2);
    pairs.map(|pair| [corners[0], pair[0], pair[1]])
}

/// Checks that numbers are within the range of coordinates.
pub(crate) fn check_coordinates<const N: usize>(
    values: [f64; N],
    place: impl Fn(usize) -> String,
) -> Result<[f64; N], Fault> {
    for (i, value) in values.into_iter().enumerate() {
        check_coordinate(value, || place(i))?;
    }
    Ok(values)
}
