//! Rays of worlds, given by origin and direction, and the points of geometries that they meet.

use etendue_world::TexturePoint;
use glam::{DVec2, DVec3};

/// A ray. Distances along the ray are multiples of `along`, which has length 1.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Its origin.
    pub from: DVec3,
    /// Its direction.
    pub along: DVec3,
}

impl Ray {
    pub(crate) fn new(from: DVec3, along: DVec3) -> Self {
        Self { from, along }
    }
}

/// A point of a geometry, in local coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Local {
    /// The geometric normal, of any length.
    pub(crate) normal: DVec3,
    /// The shading normal, if it is not the geometric normal.
    pub(crate) shading: Option<DVec3>,
    /// The point as textures see it.
    pub(crate) point: TexturePoint,
    /// The direction in which u increases.
    pub(crate) along_u: DVec3,
}

/// The hit of a ray with a geometry.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Spot {
    /// The distance, in multiples of the direction of the ray.
    pub(super) distance: f64,
    /// The number of the triangle, if the geometry is a mesh.
    pub(super) triangle: u32,
    /// The barycentric coordinates of the second and the third corner of this triangle.
    pub(super) weights: DVec2,
}

/// The smallest box around boxes, given by their lowest and highest corners; an empty box
/// at the origin if there are none.
pub(super) fn around(boxes: impl Iterator<Item = [DVec3; 2]>) -> [DVec3; 2] {
    boxes
        .reduce(|[a, b], [low, high]| [a.min(low), b.max(high)])
        .unwrap_or_default()
}
