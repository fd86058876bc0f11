//! Directions within an angle of an axis.

use crate::{about, polar};
use glam::DVec3;
use std::f64::consts::TAU;

/// A cone of directions, which are drawn evenly.
#[derive(Clone, Copy, Debug)]
pub struct Cone {
    axis: DVec3,
    /// 1 − cos of half of its angle.
    fall: f64,
}

impl Cone {
    /// All directions.
    pub const SPHERE: Self = Self {
        axis: DVec3::Z,
        fall: 2.0,
    };

    /// The directions with at least this cosine to an axis of unit length.
    #[must_use]
    pub fn new(axis: DVec3, cosine: f64) -> Self {
        Self {
            axis,
            fall: 1.0 - cosine,
        }
    }

    /// The cone in which a sphere is seen whose center is at `way` from the observer; `None` from within.
    #[must_use]
    pub fn around_sphere(way: DVec3, radius: f64) -> Option<Self> {
        let squared = way.length_squared();
        let squared_sine = radius * radius / squared;
        (squared_sine < 1.0).then(|| Self {
            axis: way / squared.sqrt(),
            // Without cancelling where the cone is narrow.
            fall: squared_sine / (1.0 + (1.0 - squared_sine).sqrt()),
        })
    }

    /// Its solid angle: directions are drawn with the inverse density.
    #[must_use]
    pub fn solid_angle(&self) -> f64 {
        TAU * self.fall
    }

    /// A direction within it.
    #[must_use]
    pub fn sample(&self, [a, b]: [f64; 2]) -> DVec3 {
        about(self.axis, polar(a * self.fall, b))
    }

    /// The density of [`Self::sample`].
    #[must_use]
    pub fn density(&self, direction: DVec3) -> f64 {
        if self.axis.dot(direction) >= 1.0 - self.fall {
            1.0 / self.solid_angle()
        } else {
            0.0
        }
    }
}
