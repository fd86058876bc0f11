//! Frames, and rays in the two-plane parameterisation.

use glam::{DQuat, DVec3};
use serde::Serialize;

/// A ray in the two-plane parameterisation of a [`Frame`]: it passes through O + x X + y Y
/// in the direction D + u X + v Y (Durand et al. 2005, section 2.1).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TwoPlane {
    /// Position along X, in metres.
    pub x: f64,
    /// Position along Y, in metres.
    pub y: f64,
    /// Slope along X: the tangent of an angle, dimensionless.
    pub u: f64,
    /// Slope along Y.
    pub v: f64,
}

impl TwoPlane {
    /// Returns 1 + u² + v² = 1/cos²θ, where θ is the angle to the central ray.
    ///
    /// If flux density in (x, y, u, v) is multiplied by the square of this factor, the result is
    /// radiance, because cos θ dω = du dv / (1 + u² + v²)².
    #[inline]
    #[must_use]
    pub fn secant_squared(&self) -> f64 {
        1.0 + self.u * self.u + self.v * self.v
    }

    /// The same ray in a parallel plane a distance `d` further along D: x' = x + d u, y' =
    /// y + d v.
    #[inline]
    #[must_use]
    pub fn travelled(&self, d: f64) -> Self {
        Self {
            x: self.x + d * self.u,
            y: self.y + d * self.v,
            ..*self
        }
    }
}

/// A right-handed orthonormal frame (X, Y, D) at O; D is the direction in which light travels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Frame {
    /// Origin O, in metres.
    #[serde(rename = "O")]
    pub origin: DVec3,
    /// Unit vector X.
    #[serde(rename = "X")]
    pub x: DVec3,
    /// Unit vector Y = D × X.
    #[serde(rename = "Y")]
    pub y: DVec3,
    /// Unit vector D.
    #[serde(rename = "D")]
    pub d: DVec3,
}

impl Frame {
    /// The identity frame of the coordinate system.
    pub const IDENTITY: Self = Self {
        origin: DVec3::ZERO,
        x: DVec3::X,
        y: DVec3::Y,
        d: DVec3::Z,
    };

    /// The frame at `origin` with D along `d`. X is along the part of `x` that is
    /// perpendicular to `d`.
    ///
    /// Returns `None` if `d` or `x` has zero length, or if they are parallel to within a
    /// millionth.
    #[must_use]
    pub fn new(origin: DVec3, d: DVec3, x: DVec3) -> Option<Self> {
        let d = d.try_normalize()?;
        let x = x.try_normalize()?;
        let across = x - d * d.dot(x);
        if across.length() < 1e-6 {
            return None;
        }
        // If the vector is short, rounding leaves a remainder along d, which is subtracted again.
        let across = across.normalize();
        let x = (across - d * d.dot(across)).normalize();
        Some(Self {
            origin,
            x,
            y: d.cross(x),
            d,
        })
    }

    /// The parallel frame a distance `distance` further along D.
    #[must_use]
    pub fn travelled(&self, distance: f64) -> Self {
        Self {
            origin: self.origin + self.d * distance,
            ..*self
        }
    }

    /// Converts `local` to world coordinates; `local` is a frame given in the coordinates of this
    /// frame.
    #[must_use]
    pub fn compose(&self, local: &Self) -> Self {
        Self {
            origin: self.to_world(local.origin),
            x: self.vector_to_world(local.x),
            y: self.vector_to_world(local.y),
            d: self.vector_to_world(local.d),
        }
    }

    /// Converts `world`, a frame given in world coordinates, to the coordinates of this frame.
    #[must_use]
    pub fn decompose(&self, world: &Self) -> Self {
        Self {
            origin: self.to_local(world.origin),
            x: self.vector_to_local(world.x),
            y: self.vector_to_local(world.y),
            d: self.vector_to_local(world.d),
        }
    }

    /// The frame turned by the smallest angle that brings D along the unit vector `d`.
    #[must_use]
    pub fn turned_to(&self, d: DVec3) -> Self {
        let turn = DQuat::from_rotation_arc(self.d, d);
        // Removes the rounding errors of the turn from the axes.
        let x = turn * self.x;
        let x = (x - d * d.dot(x)).normalize();
        Self {
            origin: self.origin,
            x,
            y: d.cross(x),
            d,
        }
    }

    /// The longitude of a direction: its angle from D towards X, radians.
    #[must_use]
    pub fn longitude(&self, direction: DVec3) -> f64 {
        libm::atan2(direction.dot(self.x), direction.dot(self.d))
    }

    /// Converts a world point to the coordinates (X, Y, D) of this frame.
    #[inline]
    #[must_use]
    pub fn to_local(&self, point: DVec3) -> DVec3 {
        self.vector_to_local(point - self.origin)
    }

    /// The world point at `local` coordinates (X, Y, D) of this frame.
    #[inline]
    #[must_use]
    pub fn to_world(&self, local: DVec3) -> DVec3 {
        self.origin + self.vector_to_world(local)
    }

    /// Converts a world vector to components along X, Y and D.
    #[inline]
    #[must_use]
    pub fn vector_to_local(&self, vector: DVec3) -> DVec3 {
        DVec3::new(vector.dot(self.x), vector.dot(self.y), vector.dot(self.d))
    }

    /// The world vector with components `local` along X, Y and D.
    #[inline]
    #[must_use]
    pub fn vector_to_world(&self, local: DVec3) -> DVec3 {
        self.x * local.x + self.y * local.y + self.d * local.z
    }
}

/// The lowest and the highest corner of the bounding box of points. If there are no points,
/// both corners are the origin.
#[must_use]
pub fn enclosing(points: &[DVec3]) -> [DVec3; 2] {
    let low = points.iter().copied().reduce(DVec3::min);
    let high = points.iter().copied().reduce(DVec3::max);
    [low, high].map(Option::unwrap_or_default)
}

/// The corners of the box between two points.
#[must_use]
pub fn box_corners(low: DVec3, high: DVec3) -> [DVec3; 8] {
    std::array::from_fn(|i| {
        let pick = |axis: usize| {
            if i >> axis & 1 == 0 {
                low[axis]
            } else {
                high[axis]
            }
        };
        DVec3::new(pick(0), pick(1), pick(2))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frame_is_right_handed_and_inverts() {
        let frame = Frame::new(
            DVec3::new(1.0, -2.0, 0.5),
            DVec3::new(0.3, -0.4, 2.0),
            DVec3::new(1.0, 0.2, 0.1),
        )
        .unwrap();
        assert!((frame.x.cross(frame.y) - frame.d).length() < 1e-15); // rounding of unit vectors
        let p = DVec3::new(0.7, 3.0, -1.1);
        assert!((frame.to_local(frame.to_world(p)) - p).length() < 1e-14); // rounding at |p| ~ 4
    }

    #[test]
    fn frame_needs_two_directions() {
        assert!(Frame::new(DVec3::ZERO, DVec3::Z, DVec3::Z).is_none());
        assert!(Frame::new(DVec3::ZERO, DVec3::ZERO, DVec3::X).is_none());
        let d = DVec3::new(0.1, 0.2, 0.3);
        assert!(Frame::new(DVec3::ZERO, d, DVec3::new(0.3, 0.6, 0.9)).is_none());
        let near = Frame::new(DVec3::ZERO, d, d + DVec3::new(1e-5, 0.0, 0.0)).unwrap();
        assert!(near.x.dot(near.d).abs() < 1e-15); // rounding of unit vectors
    }
}
