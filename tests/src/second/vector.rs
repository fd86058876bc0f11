//! Vectors and axes in plain numbers. With them, the second implementation shares no frame code
//! with the first implementation.

use crate::hostile::dice::Dice;
use etendue_field::Frame;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

pub(super) type Vector = [f64; 3];

pub(super) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: Vector, b: Vector) -> Vector {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// a + k b.
pub(super) fn plus(a: Vector, k: f64, b: Vector) -> Vector {
    [0, 1, 2].map(|i| a[i] + k * b[i])
}

pub(super) fn times(k: f64, a: Vector) -> Vector {
    a.map(|component| k * component)
}

pub(super) fn length(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

pub(super) fn unit(a: Vector) -> Vector {
    times(1.0 / length(a), a)
}

pub(super) fn distance(a: Vector, b: Vector) -> f64 {
    length(plus(a, -1.0, b))
}

/// The angle between two directions, accurate for small angles.
pub(super) fn angle(a: Vector, b: Vector) -> f64 {
    length(cross(a, b)).atan2(dot(a, b))
}

/// The component of a vector orthogonal to a unit vector, normalised.
pub(super) fn across(a: Vector, normal: Vector) -> Vector {
    unit(plus(a, -dot(a, normal), normal))
}

/// A vector rotated about a unit vector (Rodrigues 1840).
pub(super) fn turned(a: Vector, axis: Vector, by: f64) -> Vector {
    let along = times(dot(a, axis), axis);
    let aside = plus(a, -1.0, along);
    let turned = plus(times(by.cos(), aside), by.sin(), cross(axis, a));
    plus(along, 1.0, turned)
}

/// A vector after the smallest rotation that takes one unit vector to another.
pub(super) fn turned_along(a: Vector, from: Vector, to: Vector) -> Vector {
    let axis = cross(from, to);
    if length(axis) < 1e-12 {
        return a;
    }
    turned(a, unit(axis), angle(from, to))
}

/// Three orthogonal directions X, Y = D × X and D, at a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axes {
    pub(super) origin: Vector,
    pub(super) x: Vector,
    pub(super) y: Vector,
    pub(super) d: Vector,
}

impl Axes {
    /// Creates axes in which X is the component of `x` orthogonal to `d`.
    pub(super) fn new(origin: Vector, d: Vector, x: Vector) -> Self {
        let d = unit(d);
        let x = across(x, d);
        let y = cross(d, x);
        Self { origin, x, y, d }
    }

    /// The vector with the given components along X, Y and D.
    pub(super) fn vector(&self, [a, b, c]: Vector) -> Vector {
        plus(plus(times(a, self.x), b, self.y), c, self.d)
    }

    /// The point with the given coordinates along X, Y and D.
    pub(super) fn point(&self, at: Vector) -> Vector {
        plus(self.origin, 1.0, self.vector(at))
    }

    /// Converts a frame given in coordinates of these axes to world coordinates.
    pub(super) fn in_world(&self, local: &Frame) -> Frame {
        let vector = |a: DVec3| DVec3::from(self.vector(a.to_array()));
        Frame {
            origin: self.point(local.origin.to_array()).into(),
            x: vector(local.x),
            y: vector(local.y),
            d: vector(local.d),
        }
    }

    /// The components of a vector along X, Y and D.
    pub(super) fn components(&self, a: Vector) -> Vector {
        [dot(a, self.x), dot(a, self.y), dot(a, self.d)]
    }

    /// The coordinates of a point along X, Y and D.
    pub(super) fn coordinates(&self, point: Vector) -> Vector {
        self.components(plus(point, -1.0, self.origin))
    }
}

/// A random number between two bounds; its logarithm is uniformly distributed.
pub(super) fn scale(dice: &mut Dice, low: f64, high: f64) -> f64 {
    low * (high / low).powf(dice.unit())
}

/// A random direction.
pub(super) fn direction(dice: &mut Dice) -> Vector {
    let height = dice.between(-1.0, 1.0);
    let around = dice.between(0.0, TAU);
    let across = (1.0 - height * height).sqrt();
    [across * around.cos(), across * around.sin(), height]
}

/// A random direction at the given angle to a unit vector.
pub(super) fn aside(dice: &mut Dice, from: Vector, by: f64) -> Vector {
    let axis = across(direction(dice), from);
    unit(turned(from, axis, by.min(PI)))
}
