//! Surfaces of which points can be drawn, in the frame at the light.

use etendue_scene::Triangles;
use glam::DVec3;

/// A surface in flat pieces.
#[derive(Debug)]
pub(crate) enum AreaSampler {
    /// A parallelogram, by a corner and those beside it.
    One([DVec3; 3]),
    /// Triangles, and the area up to each and with it.
    Many(Triangles, Vec<f64>),
}

impl AreaSampler {
    pub(crate) fn triangles(triangles: &Triangles) -> Self {
        let mut area = 0.0;
        let upto = triangles.iter().map(|corners| {
            area += 0.5 * parallelogram(corners);
            area
        });
        Self::Many(triangles.clone(), upto.collect())
    }

    /// The whole area.
    pub(crate) fn area(&self) -> f64 {
        match self {
            Self::One(corners) => parallelogram(corners),
            Self::Many(_, upto) => upto.last().copied().unwrap_or(0.0),
        }
    }

    /// A uniform point of it and a normal there, from three numbers in (0, 1).
    pub(crate) fn point(&self, r: [f64; 3]) -> (DVec3, DVec3) {
        let [mut s, mut t, which] = r;
        let corners = match self {
            Self::One(corners) => corners,
            Self::Many(triangles, upto) => {
                if s + t > 1.0 {
                    [s, t] = [1.0 - s, 1.0 - t];
                }
                let wanted = which * self.area();
                let i = upto.partition_point(|upto| *upto < wanted);
                &triangles[i.min(upto.len() - 1)]
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
