//! Projections of positions in a plane before the receiver to slopes at the receiver.

use crate::barrier::Bounds;
use etendue_field::{Disc, Grating, Rectangle, Shape};
use std::f64::consts::TAU;

/// The relation position = origin + b · slope for some rays. Slopes are at the receiver, and
/// positions are at a distance h before the receiver.
#[derive(Clone, Copy, Debug)]
pub(super) enum SlopeProjection {
    /// Rays that arrive at the given point of the receiver: b = −h.
    At([f64; 2]),
    /// Rays that left a point light at the given distance before the receiver: b = distance − h.
    From(f64),
}

impl SlopeProjection {
    pub(super) fn origin(&self) -> [f64; 2] {
        match *self {
            Self::At(point) => point,
            Self::From(_) => [0.0; 2],
        }
    }

    /// Returns b, the change of position per unit slope, in the plane at the distance `before` the
    /// receiver.
    pub(super) fn scale(&self, before: f64) -> f64 {
        match *self {
            Self::At(_) => -before,
            Self::From(distance) => distance - before,
        }
    }

    /// Converts bounds of positions in the plane at the distance `before` to bounds of slopes.
    pub(super) fn slopes(&self, sides: Bounds, before: f64) -> Bounds {
        let (origin, scale) = (self.origin(), self.scale(before));
        [0, 1].map(|k| {
            let [a, b] = sides[k].map(|c| (c - origin[k]) / scale);
            [a.min(b), a.max(b)]
        })
    }

    /// Converts bounds of slopes to bounds of positions in the plane at the distance `before`.
    pub(super) fn positions(&self, sides: Bounds, before: f64) -> Bounds {
        let (origin, scale) = (self.origin(), self.scale(before));
        [0, 1].map(|k| {
            let [a, b] = sides[k].map(|c| origin[k] + scale * c);
            [a.min(b), a.max(b)]
        })
    }

    /// Converts a shape in a plane to slopes.
    pub(super) fn seen(&self, shape: &Shape, before: f64) -> Shape {
        let (origin, scale) = (self.origin(), self.scale(before));
        let at = |center: [f64; 2]| [0, 1].map(|k| (center[k] - origin[k]) / scale);
        match *shape {
            Shape::Rectangle(Rectangle { center, size }) => Shape::Rectangle(Rectangle {
                center: at(center),
                size: size.map(|s| s / scale.abs()),
            }),
            Shape::Disc(Disc { center, radius }) => Shape::Disc(Disc {
                center: at(center),
                radius: radius / scale.abs(),
            }),
        }
    }

    /// Converts a grating in a plane to a function of slopes.
    pub(super) fn grating(&self, grating: &Grating, before: f64) -> Grating {
        let phase = TAU * grating.frequency * self.origin()[grating.axis];
        Grating {
            frequency: grating.frequency * self.scale(before),
            phase: grating.phase + phase,
            ..*grating
        }
    }
}
