//! Rectangles with weights, whose sums represent discs.

use etendue_field::{HalfPlane, Rectangle};

/// The function weight · 1[x in `extent[0]`] · 1[y in `extent[1]`]. The function represents a
/// rectangular light or blocker, or one of the rectangles into which a disc is split.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WeightedRectangle {
    /// Lowest and highest coordinate along X and along Y, in metres; coordinates may be infinite.
    pub(crate) extent: [[f64; 2]; 2],
    pub(crate) weight: f64,
}

impl WeightedRectangle {
    pub(crate) fn of_rectangle(rectangle: &Rectangle) -> Self {
        Self {
            extent: [0, 1].map(|axis| rectangle.extent(axis)),
            weight: 1.0,
        }
    }

    pub(crate) fn of_half_plane(half_plane: &HalfPlane) -> Self {
        let mut extent = [[f64::NEG_INFINITY, f64::INFINITY]; 2];
        extent[half_plane.axis][usize::from(!half_plane.above)] = half_plane.edge;
        Self {
            extent,
            weight: 1.0,
        }
    }
}
