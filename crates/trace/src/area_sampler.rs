//! Samples points of surfaces, in the frame at the light.

use etendue_sampling::{DiscreteDistribution, triangle};
use etendue_scene::Triangles;
use glam::DVec3;

/// A surface that consists of flat pieces.
#[derive(Debug)]
pub(crate) enum AreaSampler {
    /// A parallelogram, given by a corner and the two corners next to it.
    One([DVec3; 3]),
    /// Triangles, selected in proportion to area.
    Many(Triangles, DiscreteDistribution),
}

impl AreaSampler {
    pub(crate) fn triangles(triangles: &Triangles) -> Self {
        let areas = triangles.iter().map(|corners| 0.5 * parallelogram(corners));
        Self::Many(triangles.clone(), DiscreteDistribution::new(areas))
    }

    /// The total area.
    pub(crate) fn area(&self) -> f64 {
        match self {
            Self::One(corners) => parallelogram(corners),
            Self::Many(_, areas) => areas.total(),
        }
    }

    /// A point drawn uniformly on the surface with three random numbers in (0, 1), and
    /// the surface's normal at this point.
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

/// The two edges of a parallelogram or a triangle that meet at its first corner.
fn edges([corner, b, c]: &[DVec3; 3]) -> [DVec3; 2] {
    [b - corner, c - corner]
}

/// The area of the parallelogram that three corners span.
fn parallelogram(corners: &[DVec3; 3]) -> f64 {
    let [a, b] = edges(corners);
    a.cross(b).length()
}
