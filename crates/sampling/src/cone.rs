//! Uniform sampling of directions within an angle of an axis.

use crate::{about, polar};
use glam::DVec3;
use std::f64::consts::TAU;

/// A cone whose directions are sampled uniformly.
#[derive(Clone, Copy, Debug)]
pub struct Cone {
    axis: DVec3,
    /// 1 − cos of the half-angle.
    fall: f64,
}

impl Cone {
    /// The cone of all directions.
    pub const SPHERE: Self = Self {
        axis: DVec3::Z,
        fall: 2.0,
    };

    /// A cone around an axis. It contains the directions whose angle to the axis has at
    /// least the given cosine. The axis has unit length.
    #[inline]
    #[must_use]
    pub fn new(axis: DVec3, cosine: f64) -> Self {
        Self {
            axis,
            fall: 1.0 - cosine,
        }
    }

    /// The cone of directions from an observer to a sphere. `way` is the vector from the
    /// observer to the centre of the sphere. Returns `None` if the observer is inside the sphere.
    #[inline]
    #[must_use]
    pub fn around_sphere(way: DVec3, radius: f64) -> Option<Self> {
        let squared = way.length_squared();
        let squared_sine = radius * radius / squared;
        (squared_sine < 1.0).then(|| Self {
            axis: way / squared.sqrt(),
            // This form of 1 − cos avoids cancellation for narrow cones.
            fall: squared_sine / (1.0 + (1.0 - squared_sine).sqrt()),
        })
    }

    /// The solid angle, whose inverse is the sampling density.
    #[inline]
    #[must_use]
    pub fn solid_angle(&self) -> f64 {
        TAU * self.fall
    }

    /// Samples a direction within the cone.
    #[inline]
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
