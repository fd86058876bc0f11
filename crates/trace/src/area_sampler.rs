//! Surfaces of which points can be drawn, in the frame at the light.

use etendue_sampling::{DiscreteDistribution, triangle};
use etendue_scene::Triangles;
use glam::DVec3;

/// A surface in flat pieces.
#[derive(Debug)]
pub(crate) enum AreaSampler {
    /// A parallelogram, by a corner and those beside it.
    One([DVec3; 3]),
    /// Triangles, by their areas.
    Many(Triangles, DiscreteDistribution),
}

impl AreaSampler {
    pub(crate) fn triangles(triangles: &Triangles) -> Self {
        let areas = triangles.iter().map(|corners| 0.5 * parallelogram(corners));
        Self::Many(triangles.clone(), DiscreteDistribution::new(areas))
    }

    /// The whole area.
    pub(crate) fn area(&self) -> f64 {
        match self {
            Self::One(corners) => parallelogram(corners),
            Self::Many(_, areas) => areas.total(),
        }
    }

    /// A uniform point of it and a normal there, from three numbers in (0, 1).
    pub(crate) fn point(&self, r: [f64; 3]) -> (DVec3, DVec3) {
        let [s, t, which] = r;
        let (corners, [s, t]) = match self {
            Self::One(corners) => (corners, [s, t]),
            Self::Many(triangles, areas) => {
                (&triangles[areas.sample(which)], triangle([s, t]).to_array())
            }
        };
        let [a, b] = edges(corners);
        (corners[0] + s * a + t * b, a.cross(b).normalize())
    }
}

/// The edges at the first corner.
fn edges([corner, b, c]: &[DVec3; 3]) -> [DVec3; 2] {
    [b - corner, c - corner]
}

/// The area of the parallelogram over three corners.
fn parallelogram(corners: &[DVec3; 3]) -> f64 {
    let [a, b] = edges(corners);
    a.cross(b).length()
}
