//! Conversion between rays and the coordinates of a plane.

use crate::obstacle::LegRay;
use crate::obstacle::ROUNDING;
use crate::plane::Plane;
use etendue_field::{Frame, Orientation, Patch, Quantity, Side, TwoPlane};
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

impl Plane {
    /// The coordinates at the plane of a ray that leaves a point along a unit vector.
    /// Returns `None` if the ray misses.
    #[must_use]
    pub fn arrival(&self, point: DVec3, direction: DVec3) -> Option<[f64; 4]> {
        let (coordinates, _) = self.coordinates(&LegRay { point, direction })?;
        Some(coordinates)
    }

    /// The coordinates at the plane of a ray on its last leg, and the factor that converts
    /// the ray's flux to the recorded quantity in ray space. Returns `None` if the ray misses.
    pub(crate) fn coordinates(&self, ray: &LegRay) -> Option<([f64; 4], f64)> {
        match self.orientation {
            Orientation::Orthogonal => self.across(ray),
            Orientation::Tangent => {
                let (s, t) = crossing(&self.frame, ray)?;
                self.on_surface([s, t], ray.direction, &self.frame)
            }
            Orientation::LocalNormals | Orientation::Mirrored => {
                let (point, normal) = self.hit(ray)?;
                let at = self.frame.to_local(point);
                self.on_surface([at.x, at.y], ray.direction, &self.frame.turned_to(normal))
            }
        }
    }

    /// The distance along a ray of the last leg to the plane, or to the plane's surface if
    /// it has one. The distance is zero for a plane on a surface that light leaves. Returns `None`
    /// if the ray misses the plane or its surface, or if the plane lies on the next surface and the
    /// ray's start lies behind it.
    pub(crate) fn along(&self, ray: &LegRay) -> Option<f64> {
        if self.orientation != Orientation::Orthogonal && !self.is_arriving() {
            return Some(0.0);
        }
        if let Some(patch) = &self.patch {
            return Some(self.arrives_on(patch, ray)?.0 * (1.0 - ROUNDING));
        }
        let t = (self.frame.origin - ray.point).dot(self.frame.d) / ray.direction.dot(self.frame.d);
        let is_behind = self.is_arriving() && t < 0.0;
        // Rounding must not decide whether an object at the distance of the plane stops its light.
        let share = match self.side {
            Side::Before => 1.0 - ROUNDING,
            Side::After => 1.0 + ROUNDING,
        };
        (t.is_finite() && !is_behind).then_some(t * share)
    }

    /// The ray that has the given coordinates on the plane or on the plane's surface, in
    /// the direction of light. Also returns the étendue per dx dy du dv at this ray. This is the
    /// inverse of [`Self::coordinates`]. Returns `None` if there is no such ray.
    pub(crate) fn ray(&self, [x, y, u, v]: [f64; 4]) -> Option<(LegRay, f64)> {
        let foot = self.frame.to_world(DVec3::new(x, y, 0.0));
        if self.orientation == Orientation::Orthogonal {
            let along = DVec3::new(u, v, 1.0);
            let ray = LegRay {
                point: foot,
                direction: self.frame.vector_to_world(along.normalize()),
            };
            return Some((ray, along.length_squared().powi(-2)));
        }
        let (point, normal) = self.point([x, y])?;
        let away = self.away([u, v])?;
        let towards = self.frame.turned_to(normal).vector_to_world(away);
        let direction = if self.is_arriving() {
            -towards
        } else {
            towards
        };
        // On a curved surface, dx dy is the surface area projected onto the tangent plane.
        let etendue = away.z * libm::cos(v) / normal.dot(self.frame.d);
        Some((LegRay { point, direction }, etendue))
    }

    /// The point with two given coordinates on the plane or on the plane's surface, and
    /// the normal at this point on the side of D. Returns `None` if the surface has no point with
    /// these coordinates.
    pub(crate) fn point(&self, [x, y]: [f64; 2]) -> Option<(DVec3, DVec3)> {
        let foot = self.frame.to_world(DVec3::new(x, y, 0.0));
        match &self.patch {
            None => Some((foot, self.frame.d)),
            Some(patch) => self.above(foot, patch),
        }
    }

    /// The direction, relative to the normal, that has two given angles at a plane on a
    /// surface. Returns `None` if an angle exceeds a right angle, because the same direction would
    /// then have two pairs of angles.
    pub(crate) fn away(&self, [u, v]: [f64; 2]) -> Option<DVec3> {
        let turned = if self.orientation == Orientation::Mirrored {
            -1.0
        } else {
            1.0
        };
        let angles = [turned * (u + self.longitude), turned * v];
        let [(sin, cos), (up, across)] = angles.map(libm::sincos);
        let is_in_front = angles.iter().all(|angle| angle.abs() < FRAC_PI_2);
        is_in_front.then(|| DVec3::new(across * sin, up, across * cos))
    }

    /// The point of a patch above a point of the tangent plane, and its normal on the side
    /// of D.
    fn above(&self, foot: DVec3, patch: &Patch) -> Option<(DVec3, DVec3)> {
        let d = self.frame.d;
        let down = LegRay::back(patch, foot, d);
        let (distance, normal) = down.met(patch)?;
        let side = normal.dot(d).signum();
        Some((down.point - distance * d, normal * side))
    }

    /// The factor that converts radiance to the plane's recorded quantity, for a ray in
    /// the plane's coordinates.
    pub(crate) fn factor(&self, [.., u, v]: [f64; 4]) -> f64 {
        match (self.orientation, self.quantity) {
            (_, Quantity::Radiance) => 1.0,
            (Orientation::Orthogonal, Quantity::DifferentialIrradiance) => {
                (1.0 + u * u + v * v).powi(-2)
            }
            (_, Quantity::DifferentialIrradiance) => {
                libm::cos(u + self.longitude) * libm::cos(v) * libm::cos(v)
            }
        }
    }

    fn across(&self, ray: &LegRay) -> Option<([f64; 4], f64)> {
        let z = ray.across(&self.frame)?;
        let [x, y, u, v] = z;
        let secant_squared = TwoPlane { x, y, u, v }.secant_squared();
        Some((z, secant_squared * secant_squared * self.factor(z)))
    }

    /// The point where a ray leaves the surface that it met last, or where the ray meets
    /// the plane's surface. Also returns the unit normal at this point, on the side of the plane's
    /// D.
    fn hit(&self, ray: &LegRay) -> Option<(DVec3, DVec3)> {
        let Some(patch) = &self.patch else {
            let (s, t) = crossing(&self.frame, ray)?;
            let point = self.frame.to_world(DVec3::new(s, t, 0.0));
            return Some((point, self.frame.d));
        };
        let (point, normal) = if self.is_arriving() {
            let (distance, normal) = self.arrives_on(patch, ray)?;
            (ray.point + ray.direction * distance, normal)
        } else {
            let gradient = patch.gradient(patch.frame.to_local(ray.point));
            let normal = patch.frame.vector_to_world(gradient.try_normalize()?);
            (ray.point, normal)
        };
        let side = normal.dot(self.frame.d).signum();
        Some((point, normal * side))
    }

    /// The point where a ray meets the surface of the plane from the side of the plane's D.
    fn arrives_on(&self, patch: &Patch, ray: &LegRay) -> Option<(f64, DVec3)> {
        ray.met_from(patch, patch.frame.d.dot(self.frame.d).signum())
    }

    /// A direction's two angles relative to the D of `local`, or `None` if the direction
    /// points into the surface.
    fn on_surface(
        &self,
        [s, t]: [f64; 2],
        direction: DVec3,
        local: &Frame,
    ) -> Option<([f64; 4], f64)> {
        let away = if self.is_arriving() {
            -direction
        } else {
            direction
        };
        let away = local.vector_to_local(away);
        let (mut theta, mut phi) = (libm::atan2(away.x, away.z), libm::asin(away.y));
        if self.orientation == Orientation::Mirrored {
            (theta, phi) = (-theta, -phi);
        }
        let z = [s, t, theta - self.longitude, phi];
        let projected = libm::cos(theta) * libm::cos(phi) * libm::cos(phi);
        (away.z > 0.0).then(|| (z, self.factor(z) / projected))
    }
}

impl LegRay {
    /// The ray's position and slopes in the plane (X, Y) of a frame, or `None` if the
    /// ray's direction has no positive component along D.
    pub(super) fn across(&self, frame: &Frame) -> Option<[f64; 4]> {
        let (x, y) = crossing(frame, self)?;
        let towards = frame.vector_to_local(self.direction);
        let slopes = [towards.x, towards.y].map(|t| t / towards.z);
        (towards.z > 0.0).then_some([x, y, slopes[0], slopes[1]])
    }
}

/// The coordinates of the point where a ray, extended to a line, crosses the plane (X, Y)
/// of a frame.
fn crossing(frame: &Frame, ray: &LegRay) -> Option<(f64, f64)> {
    let (at, towards) = (
        frame.to_local(ray.point),
        frame.vector_to_local(ray.direction),
    );
    let t = -at.z / towards.z;
    t.is_finite()
        .then_some((at.x + t * towards.x, at.y + t * towards.y))
}
