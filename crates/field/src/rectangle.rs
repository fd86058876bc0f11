//! Rectangles across the central ray.

use serde::Serialize;

/// A rectangle in a plane orthogonal to the central ray. Its edges are along X and Y, and its
/// coordinates are relative to the ray.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rectangle {
    /// Centre (x, y), in metres.
    pub center: [f64; 2],
    /// Side lengths along X and Y, in metres.
    pub size: [f64; 2],
}

impl Rectangle {
    /// The lowest and highest coordinate along X (`axis` 0) or Y (`axis` 1).
    #[inline]
    #[must_use]
    pub fn extent(&self, axis: usize) -> [f64; 2] {
        let half = 0.5 * self.size[axis];
        [self.center[axis] - half, self.center[axis] + half]
    }

    /// Checks whether the point (x, y) lies in the rectangle, edges included.
    #[inline]
    #[must_use]
    pub fn contains(&self, x: f64, y: f64) -> bool {
        let along_x = 2.0 * (x - self.center[0]).abs() <= self.size[0];
        let along_y = 2.0 * (y - self.center[1]).abs() <= self.size[1];
        // Both comparisons are made, because the processor could not predict the result of one.
        along_x & along_y
    }

    /// The largest absolute coordinate of a point of the rectangle.
    #[must_use]
    pub fn reach(&self) -> f64 {
        let ends = [self.extent(0), self.extent(1)];
        ends.as_flattened()
            .iter()
            .fold(0.0, |m: f64, v| m.max(v.abs()))
    }

    /// The area, in square metres.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.size[0] * self.size[1]
    }
}
