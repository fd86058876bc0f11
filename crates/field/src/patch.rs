//! Smooth surfaces: pieces of quadrics.

use crate::{Frame, box_corners};
use glam::DVec3;
use serde::Serialize;

/// A smooth piece of a quadric around the quadric's vertex. The quadric is a plane, sphere,
/// cylinder or paraboloid.
///
/// In coordinates (s, t, h) along X, Y and D of the patch's frame, where D is the normal at the
/// vertex, the points of the patch satisfy k₁ s² + k₂ t² + k₃ h² + 2 h = 0. The curvature in a
/// plane through D is positive if the surface is convex on the side of D, as in docs/theory.md. A
/// sphere of radius R has k = (1/R, 1/R, 1/R), a cylinder around an axis along Y has k = (1/R, 0,
/// 1/R), a paraboloid has k = (k₁, k₂, 0), and a plane has k = (0, 0, 0).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Patch {
    /// The frame of the patch: O is at the vertex, D is along the normal at the vertex, and X and Y
    /// are along the principal directions.
    pub frame: Frame,
    /// Curvatures k₁, k₂ and k₃, per metre.
    pub curvature: [f64; 3],
    /// Radius of the patch, metres: its points satisfy s² + t² ≤ aperture².
    pub aperture: f64,
}

impl Patch {
    /// The patch in the coordinates of `frame`. `frame` is given in the same coordinates as
    /// the patch's frame.
    #[must_use]
    pub fn seen_from(&self, frame: &Frame) -> Self {
        Self {
            frame: frame.decompose(&self.frame),
            ..*self
        }
    }

    /// The point of the patch over (s, t), in the coordinates in which the patch's frame is
    /// given. The result is NaN if (s, t) lies beyond the half of the quadric that contains the
    /// vertex.
    #[must_use]
    pub fn point(&self, s: f64, t: f64) -> DVec3 {
        let [a, b, c] = self.curvature;
        let bend = a * s * s + b * t * t;
        let h = -bend / (1.0 + (1.0 - c * bend).sqrt());
        self.frame.to_world(DVec3::new(s, t, h))
    }

    /// The corners of a bounding box, in the coordinates in which the patch's frame is
    /// given.
    #[must_use]
    pub fn corners(&self) -> [DVec3; 8] {
        // At the distance r from the normal through the vertex, the half that contains the vertex
        // deviates along this normal by at most |k| r².
        let most = self
            .curvature
            .iter()
            .fold(0.0_f64, |most, k| most.max(k.abs()));
        let a = self.aperture;
        let half = DVec3::new(a, a, most * a * a);
        box_corners(-half, half).map(|p| self.frame.to_world(p))
    }

    /// The unit normal at a point near the patch, on the side of D at the vertex. Point
    /// and normal are in the coordinates in which the patch's frame is given.
    #[inline]
    #[must_use]
    pub fn normal(&self, point: DVec3) -> DVec3 {
        let gradient = self.gradient(self.frame.to_local(point));
        self.frame.vector_to_world(gradient).normalize()
    }

    /// Returns k₁ s² + k₂ t² + k₃ h² + 2 h at a point (s, t, h) of the patch's frame: zero on the
    /// surface, positive in front of the surface.
    #[inline]
    #[must_use]
    pub fn value(&self, point: DVec3) -> f64 {
        let [a, b, c] = self.curvature;
        let DVec3 { x, y, z } = point;
        a * x * x + b * y * y + c * z * z + 2.0 * z
    }

    /// Half of the gradient of [`value`](Self::value), in the patch's frame. The gradient
    /// is along the normal, on the side of D. The last component is positive on the half of the
    /// quadric that contains the vertex.
    #[inline]
    #[must_use]
    pub fn gradient(&self, point: DVec3) -> DVec3 {
        let [a, b, c] = self.curvature;
        DVec3::new(a * point.x, b * point.y, c * point.z + 1.0)
    }

    /// The parameters t, ascending, at which the points start + t · direction lie on the
    /// patch. `start` and `direction` are in the patch's frame. A parameter without such a point is
    /// NaN.
    #[inline]
    #[must_use]
    pub fn hits(&self, start: DVec3, direction: DVec3) -> [f64; 2] {
        let curved = DVec3::from(self.curvature) * direction;
        let (a, b, c) = (
            curved.dot(direction),
            curved.dot(start) + direction.z,
            self.value(start),
        );
        // To avoid cancellation, the other root is computed as the constant term divided by this
        // root.
        let q = -(b + (b * b - a * c).sqrt().copysign(b));
        let on_patch = |t: f64| {
            let on = t.is_finite() && self.contains(start + t * direction);
            if on { t } else { f64::NAN }
        };
        let [s, t] = [q / a, c / q].map(on_patch);
        [s.min(t), s.max(t)]
    }

    /// Checks whether a point of the quadric, in the patch's frame, belongs to the patch.
    #[inline]
    #[must_use]
    pub fn contains(&self, point: DVec3) -> bool {
        let across = point.x * point.x + point.y * point.y;
        across <= self.aperture * self.aperture && self.gradient(point).z > 0.0
    }
}

impl Specular {
    /// The direction of a ray after it meets a surface at `point`. `normal` is the unit
    /// normal at this point, on the side that the surface faces. All vectors are in one frame, and
    /// the direction may have any length. `lens` is the frame of a lens. Returns `None` if a
    /// surface that refracts reflects the ray totally.
    #[must_use]
    pub fn turned(
        &self,
        lens: &Frame,
        normal: DVec3,
        point: DVec3,
        direction: DVec3,
    ) -> Option<DVec3> {
        match *self {
            Self::Mirror => Some(direction - 2.0 * direction.dot(normal) * normal),
            Self::Refraction { front, back } => {
                let along = direction.normalize();
                let from_front = along.dot(normal) < 0.0;
                let (normal, ratio) = if from_front {
                    (normal, front / back)
                } else {
                    (-normal, back / front)
                };
                let cosine = -along.dot(normal);
                let squared = 1.0 - ratio * ratio * (1.0 - cosine * cosine);
                (squared > 0.0).then(|| ratio * along + (ratio * cosine - squared.sqrt()) * normal)
            }
            Self::ThinLens { focal_length } => {
                let at = lens.to_local(point);
                let local = lens.vector_to_local(direction);
                let ahead = local.z.abs();
                let bent = |slope: f64, x: f64| slope / ahead - x / focal_length;
                let turned = DVec3::new(bent(local.x, at.x), bent(local.y, at.y), local.z.signum());
                Some(lens.vector_to_world(turned))
            }
        }
    }
}

/// The event of a ray at a specular surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum Specular {
    /// Mirror reflection.
    Mirror,
    /// Refraction by Snell's law, without reflection.
    Refraction {
        /// Index of refraction on the side of the normal.
        front: f64,
        /// Index of refraction on the side opposite to the normal.
        back: f64,
    },
    /// A flat lens without thickness. The lens reduces each slope of a ray by the ray's position
    /// divided by the focal length.
    ThinLens {
        /// Focal length, metres; negative for a diverging lens.
        focal_length: f64,
    },
}
