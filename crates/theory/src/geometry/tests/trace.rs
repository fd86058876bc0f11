//! Rays traced in space by elementary geometry, as a reference for the maps.

use super::*;

pub(super) type Vector = [f64; 3];

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A + t b.
fn along(a: Vector, t: f64, b: Vector) -> Vector {
    [0, 1, 2].map(|i| a[i] + t * b[i])
}

fn scaled(a: Vector, t: f64) -> Vector {
    a.map(|x| t * x)
}

/// The axes (X, Y, D) of a light frame at the origin. Their components are along the axes (T, B, N)
/// of the surface.
#[derive(Clone, Copy)]
pub(super) struct LightAxes([Vector; 3]);

impl LightAxes {
    /// The axes for light that seems to come from the angle θ, with D = −(sin θ T + cos θ
    /// N).
    pub(super) fn coming(theta: f64) -> Self {
        let (sin, cos) = libm::sincos(theta);
        Self([[-cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, -cos]])
    }

    /// The axes for light that leaves at the angle θ, with D = sin θ T + cos θ N.
    pub(super) fn leaving(theta: f64) -> Self {
        let (sin, cos) = libm::sincos(theta);
        Self([[cos, 0.0, -sin], [0.0, 1.0, 0.0], [sin, 0.0, cos]])
    }

    /// The axes with X and Y turned about D, from X towards Y.
    pub(super) fn turned(&self, angle: f64) -> Self {
        let Self([x, y, d]) = *self;
        let (sin, cos) = libm::sincos(angle);
        let turned = along(scaled(x, cos), sin, y);
        Self([turned, along(scaled(y, cos), -sin, x), d])
    }

    /// The origin and unit direction of a ray.
    pub(super) fn ray(&self, [x, y, u, v]: [f64; 4]) -> [Vector; 2] {
        let Self([ex, ey, d]) = *self;
        let direction = along(along(d, u, ex), v, ey);
        let length = dot(direction, direction).sqrt();
        let origin = along(scaled(ex, x), y, ey);
        [origin, scaled(direction, 1.0 / length)]
    }

    /// The two-plane coordinates of a ray.
    pub(super) fn coordinates(&self, [point, direction]: [Vector; 2]) -> [f64; 4] {
        let Self([ex, ey, d]) = *self;
        let forward = dot(direction, d);
        let foot = along(point, -dot(point, d) / forward, direction);
        let slope = |axis| dot(direction, axis) / forward;
        [dot(foot, ex), dot(foot, ey), slope(ex), slope(ey)]
    }
}

/// The surface 2 N·p + pᵀ Q p = 0 through the origin. If Q is k times the identity, the surface is
/// a sphere of curvature k. Otherwise it is a graph with the shape operator M.
#[derive(Clone, Copy)]
pub(super) struct GraphSurface([Vector; 3]);

impl GraphSurface {
    pub(super) fn sphere(k: f64) -> Self {
        Self([[k, 0.0, 0.0], [0.0, k, 0.0], [0.0, 0.0, k]])
    }

    pub(super) fn graph([[a, b], [c, d]]: Matrix<2>) -> Self {
        Self([[a, b, 0.0], [c, d, 0.0], [0.0; 3]])
    }

    fn quadratic(&self, p: Vector) -> Vector {
        self.0.map(|row| dot(row, p))
    }

    /// The point near the origin where a ray meets the surface, and the unit normal at this
    /// point.
    fn hit(&self, [o, d]: [Vector; 2]) -> [Vector; 2] {
        let a = dot(d, self.quadratic(d));
        let half_b = dot(o, self.quadratic(d)) + d[2];
        let c = dot(o, self.quadratic(o)) + 2.0 * o[2];
        let root = (half_b * half_b - a * c).sqrt().copysign(half_b);
        let point = along(o, -c / (half_b + root), d);
        let normal = along([0.0, 0.0, 1.0], 1.0, self.quadratic(point));
        [point, scaled(normal, 1.0 / dot(normal, normal).sqrt())]
    }
}

/// Traces a ray that meets a surface at the angle of incidence θ₀ and is reflected. The ray is given in the frame
/// before the reflection and returned in the frame after it.
pub(super) fn reflected(surface: GraphSurface, theta0: f64, z: [f64; 4]) -> [f64; 4] {
    let ray = LightAxes::coming(theta0).ray(z);
    let [point, n] = surface.hit(ray);
    let direction = along(ray[1], -2.0 * dot(ray[1], n), n);
    LightAxes::leaving(-theta0).coordinates([point, direction])
}

/// Traces a ray that a surface at the angle of incidence θ₀ refracts. The ray is given in the frame
/// before the refraction and returned in the frame after it.
pub(super) fn refracted(
    surface: GraphSurface,
    theta0: f64,
    media: &Media,
    z: [f64; 4],
) -> [f64; 4] {
    let ray = LightAxes::coming(theta0).ray(z);
    let [point, n] = surface.hit(ray);
    let ratio = media.before / media.after;
    let cosine = -dot(ray[1], n);
    let after = (1.0 - ratio * ratio * (1.0 - cosine * cosine)).sqrt();
    let direction = along(scaled(ray[1], ratio), ratio * cosine - after, n);
    let theta2 = libm::asin(ratio * libm::sin(theta0));
    LightAxes::coming(theta2).coordinates([point, direction])
}
