use crate::Frame;
use glam::DVec3;
use serde::Serialize;

/// A smooth piece of a quadric around its vertex: plane, sphere, cylinder or paraboloid.
///
/// In coordinates (s, t, h) along X, Y and D of its frame, D being the normal at the vertex, its points satisfy
/// k₁ s² + k₂ t² + k₃ h² + 2 h = 0. The curvature in a plane through D is positive where the surface is convex seen from D,
/// as in docs/theory.md: a sphere of radius R has k = (1/R, 1/R, 1/R), a cylinder around an axis along Y (1/R, 0, 1/R),
/// a paraboloid (k₁, k₂, 0), a plane zeros.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Patch {
    /// O at the vertex, D the normal there, X and Y the principal directions.
    pub frame: Frame,
    /// k₁, k₂ and k₃, per metre.
    pub curvature: [f64; 3],
    /// Radius of the patch, metres: its points satisfy s² + t² ≤ aperture².
    pub aperture: f64,
}

impl Patch {
    /// k₁ s² + k₂ t² + k₃ h² + 2 h at a point (s, t, h) of its frame: zero on the surface, positive before it.
    #[inline]
    #[must_use]
    pub fn value(&self, point: DVec3) -> f64 {
        let [a, b, c] = self.curvature;
        let DVec3 { x, y, z } = point;
        a * x * x + b * y * y + c * z * z + 2.0 * z
    }

    /// Half the gradient of [`value`](Self::value), in its frame: along the normal, on the side of D. Its last component is
    /// positive on the half of the quadric that holds the vertex.
    #[inline]
    #[must_use]
    pub fn gradient(&self, point: DVec3) -> DVec3 {
        let [a, b, c] = self.curvature;
        DVec3::new(a * point.x, b * point.y, c * point.z + 1.0)
    }

    /// Whether a point of the quadric, in its frame, belongs to the patch.
    #[inline]
    #[must_use]
    pub fn contains(&self, point: DVec3) -> bool {
        let across = point.x * point.x + point.y * point.y;
        across <= self.aperture * self.aperture && self.gradient(point).z > 0.0
    }
}

/// What a specular surface does to a ray.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum Specular {
    /// Turns it back at the angle at which it came.
    Mirror,
    /// Lets it through by Snell's law; nothing is reflected.
    Refraction {
        /// Index of refraction on the side of the normal.
        front: f64,
        /// Index on the other side.
        back: f64,
    },
    /// A flat lens without thickness: slopes across it fall by position over focal length.
    ThinLens {
        /// Metres; negative if it spreads light.
        focal_length: f64,
    },
}
