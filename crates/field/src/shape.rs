//! Flat shapes across the central ray.

use crate::{Rectangle, TwoPlane};
use glam::DVec3;
use serde::Serialize;

/// A disc in a plane orthogonal to the central ray, with coordinates relative to the ray.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Disc {
    /// Centre (x, y), in metres.
    pub center: [f64; 2],
    /// Radius, in metres.
    pub radius: f64,
}

impl Disc {
    /// Checks whether the point (x, y) lies in the disc, its edge included.
    #[inline]
    #[must_use]
    pub fn contains(&self, x: f64, y: f64) -> bool {
        let [dx, dy] = [x - self.center[0], y - self.center[1]];
        dx * dx + dy * dy <= self.radius * self.radius
    }
}

/// A bounded flat shape in a plane orthogonal to the central ray.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum Shape {
    /// A rectangle, edges along X and Y.
    Rectangle(Rectangle),
    /// A disc.
    Disc(Disc),
}

impl Shape {
    /// Checks whether the point (x, y) lies in the shape, edges included.
    #[inline]
    #[must_use]
    pub fn contains(&self, x: f64, y: f64) -> bool {
        match self {
            Self::Rectangle(rectangle) => rectangle.contains(x, y),
            Self::Disc(disc) => disc.contains(x, y),
        }
    }

    /// The smallest rectangle that contains the shape.
    #[must_use]
    pub fn bounds(&self) -> Rectangle {
        match *self {
            Self::Rectangle(rectangle) => rectangle,
            Self::Disc(Disc { center, radius }) => Rectangle {
                center,
                size: [2.0 * radius; 2],
            },
        }
    }

    /// The area, in square metres.
    #[must_use]
    pub fn area(&self) -> f64 {
        match self {
            Self::Rectangle(rectangle) => rectangle.area(),
            Self::Disc(disc) => std::f64::consts::PI * disc.radius * disc.radius,
        }
    }

    /// The variances along x and y of points that are uniform in the shape, in square metres.
    #[must_use]
    pub fn variances(&self) -> [f64; 2] {
        match self {
            Self::Rectangle(rectangle) => rectangle.size.map(|side| side * side / 12.0),
            Self::Disc(Disc { radius, .. }) => [0.25 * radius * radius; 2],
        }
    }

    /// The shape with another centre.
    #[must_use]
    pub fn centered_at(&self, center: [f64; 2]) -> Self {
        match *self {
            Self::Rectangle(Rectangle { size, .. }) => Self::Rectangle(Rectangle { center, size }),
            Self::Disc(Disc { radius, .. }) => Self::Disc(Disc { center, radius }),
        }
    }

    /// The shape after a scaling of its plane by a factor, which may be negative, and a shift in
    /// metres.
    #[must_use]
    pub fn mapped(&self, factor: f64, shift: [f64; 2]) -> Self {
        let old = self.bounds().center;
        let center = [0, 1].map(|axis| factor * old[axis] + shift[axis]);
        match *self {
            Self::Rectangle(Rectangle { size, .. }) => Self::Rectangle(Rectangle {
                center,
                size: size.map(|side| side * factor.abs()),
            }),
            Self::Disc(Disc { radius, .. }) => Self::Disc(Disc {
                center,
                radius: radius * factor.abs(),
            }),
        }
    }
}

/// The distance along the central ray at which a ray meets a triangle. The triangle is
/// given in the frame of the ray's coordinates.
///
/// The corners are projected along the ray, and the ray meets the triangle if the projected
/// triangle contains the origin. For two triangles with a common edge, the same two products are
/// computed for this edge, so no ray passes between the triangles (Woop, Benthin and Wald 2013,
/// *Watertight ray/triangle intersection*, which introduces this projection).
#[inline]
#[must_use]
pub fn triangle_distance(corners: &[DVec3; 3], ray: &TwoPlane) -> Option<f64> {
    let (weights, sum, inside) = triangle_weights(corners, ray);
    let depth: f64 = weights.iter().zip(corners).map(|(w, p)| w * p.z).sum();
    inside.then(|| {
        // Rounding must not move the hit in front of the triangle's nearest corner, because a
        // virtual plane may be just before the triangle.
        let [a, b, c] = corners.map(|p| p.z);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        (depth / sum).max(low).min(high)
    })
}

/// Checks whether a ray meets a triangle, as [`triangle_distance`] decides.
#[inline]
#[must_use]
pub fn triangle_is_met(corners: &[DVec3; 3], ray: &TwoPlane) -> bool {
    triangle_weights(corners, ray).2
}

/// The areas that a ray and the edges of a triangle span as seen along the ray, the sum of
/// these areas, and whether the ray meets the triangle.
#[inline]
fn triangle_weights(corners: &[DVec3; 3], ray: &TwoPlane) -> ([f64; 3], f64, bool) {
    let [a, b, c] = corners.map(|p| [p.x - ray.x - ray.u * p.z, p.y - ray.y - ray.v * p.z]);
    let cross = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
    let [p, q, r] = [cross(b, c), cross(c, a), cross(a, b)];
    let sum: f64 = [p, q, r].iter().sum();
    // There are no branches, because the processor could not predict them.
    let inside = (p >= 0.0) & (q >= 0.0) & (r >= 0.0) | (p <= 0.0) & (q <= 0.0) & (r <= 0.0);
    ([p, q, r], sum, inside & (sum != 0.0))
}

/// The unit normal at a point of a triangle, interpolated between the normals at its
/// corners.
#[must_use]
pub fn interpolated_normal(corners: &[DVec3; 3], normals: &[DVec3; 3], point: DVec3) -> DVec3 {
    let [a, b, c] = corners;
    let whole = (b - a).cross(c - a);
    let share = |p: &DVec3, q: &DVec3| (p - point).cross(q - point).dot(whole);
    let [p, q, r] = normals;
    (p * share(b, c) + q * share(c, a) + r * share(a, b)).normalize()
}

/// Returns the ratio of two radiances of light that comes along `came` and leaves along `leaves`:
/// behind a triangle whose interpolated normal is `normal`, and behind a surface that really has this
/// normal. `facet` is the normal of the triangle's plane; the vectors may have any length. The ratio
/// is negative if light is on the wrong side of the triangle either before or after its deflection.
///
/// A triangle turns light about the interpolated normal, but receives and emits it through its own
/// area. So interpolated normals do not conserve étendue (Veach 1997, section 5.3).
#[must_use]
pub fn facet_ratio(facet: DVec3, normal: DVec3, came: DVec3, leaves: DVec3) -> f64 {
    let kept = |d: DVec3| d.dot(facet) / d.dot(normal);
    kept(came) / kept(leaves)
}

/// The points of a plane on one side of a line along X or Y.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HalfPlane {
    /// The axis of the coordinate that is compared: 0 for x, 1 for y.
    pub axis: usize,
    /// The coordinate of the edge, in metres.
    pub edge: f64,
    /// Whether the half-plane contains the coordinates above the edge. If not, it contains the
    /// coordinates below the edge.
    pub above: bool,
}

impl HalfPlane {
    /// Checks whether the point (x, y) lies in the half-plane, its edge included.
    #[inline]
    #[must_use]
    pub fn contains(&self, x: f64, y: f64) -> bool {
        let coordinate = if self.axis == 0 { x } else { y };
        if self.above {
            coordinate >= self.edge
        } else {
            coordinate <= self.edge
        }
    }
}

/// A semi-transparent cosine grating, ½ (1 + m cos(2π f t + p)), where t is x or y.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Grating {
    /// The axis along which the grating varies: 0 for x, 1 for y.
    pub axis: usize,
    /// Frequency f, in cycles per metre.
    pub frequency: f64,
    /// Modulation m, 0 to 1.
    pub modulation: f64,
    /// Phase p, in radians.
    pub phase: f64,
}

impl Grating {
    /// The share of radiance that passes at (x, y).
    #[inline]
    #[must_use]
    pub fn transmittance(&self, x: f64, y: f64) -> f64 {
        let t = if self.axis == 0 { x } else { y };
        let angle = std::f64::consts::TAU * self.frequency * t + self.phase;
        0.5 * (1.0 + self.modulation * libm::cos(angle))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tests triangles that are perpendicular to the path, because a plane just before a mesh may
    /// touch such a triangle.
    #[test]
    fn rounding_puts_no_hit_beside_its_triangle() {
        let z = 0.728_987_365_116_f64;
        let corners = [(-0.1, -0.1), (0.3, -0.2), (0.05, 0.3)].map(|(x, y)| DVec3::new(x, y, z));
        for i in 0..1000 {
            let u = f64::from(i) / 1001.0 - 0.5;
            let (x, y) = (0.05 - u * z, 0.02 + 0.7 * u * z);
            let v = -0.7 * u;
            let found = triangle_distance(&corners, &TwoPlane { x, y, u, v });
            assert_eq!(found.map(f64::to_bits), Some(z.to_bits()));
        }
    }
}
