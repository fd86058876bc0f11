//! How many nodes a quadrature has.

use super::System;
use crate::rays::Plane;
use etendue_field::{Orientation, Pattern, Window};

/// How many nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Rule {
    /// Along x, y, u and v: a midpoint rule over the window.
    pub(super) plane: [usize; 4],
    /// Along each side of a part of the light: a Gauss rule; 1 where there is no light with an extent.
    pub(super) light: usize,
    /// Along x and y: their number is a multiple of these, so that tiles of a checkerboard end between them.
    pub(super) tiles: [usize; 2],
}

/// Nodes over the light that are enough for a look.
pub(super) const FEW: usize = 4;

/// How many tiles of a checkerboard the window of a plane on the surface holds along an axis, if they fit; else 1.
pub(super) fn tiles(system: &System, plane: &Plane, window: &Window, axis: usize) -> usize {
    let reflectance = &system.reflectance;
    let patterns = reflectance.blend.iter().map(|(_, pattern)| pattern);
    let mut periods = patterns
        .chain(&reflectance.texture)
        .filter_map(|p| match p {
            Pattern::Checkerboard { period } => Some(*period),
            _ => None,
        });
    let axes = [plane.frame.x, plane.frame.y];
    let own = [system.patch.frame.x, system.patch.frame.y];
    let along = axes[axis].dot(own[axis]).abs() > 1.0 - 1e-9;
    let centered = (plane.frame.origin - system.patch.frame.origin).length() < 1e-9;
    let is_flat = system.patch.curvature.iter().all(|k| k.abs() <= 0.0);
    let on_it =
        plane.orientation.is_local() || plane.orientation == Orientation::Tangent && is_flat;
    let Some(period) = periods.next_back().filter(|_| along && centered && on_it) else {
        return 1;
    };
    let half = [window.x, window.y][axis].half_width();
    let tiles = 4.0 * half / period;
    let fit = (tiles - tiles.round()).abs() < 1e-9 && (1.0..1e3).contains(&tiles);
    // The middle of the window is the end of a tile too.
    let pairs = 2 * whole(0.5 * tiles.round());
    let count = whole(tiles.round());
    match (fit, count == pairs) {
        (false, _) => 1,
        (true, true) => count,
        (true, false) => 2 * count,
    }
}

impl Rule {
    /// Nodes over the plane.
    pub(super) fn places(&self) -> f64 {
        self.plane.iter().map(|n| *n as f64).product()
    }

    pub(super) fn coarser(self) -> Self {
        Self {
            plane: self.plane.map(|n| (n * 3).div_ceil(5)),
            light: self.light.min(FEW),
            ..self
        }
        .aligned()
    }

    pub(super) fn finer_along(mut self, axis: usize) -> Self {
        self.plane[axis] = (self.plane[axis] * 4).div_ceil(3);
        self.aligned()
    }

    pub(super) fn aligned(mut self) -> Self {
        for (nodes, tiles) in self.plane.iter_mut().zip(self.tiles) {
            *nodes = nodes.next_multiple_of(tiles);
        }
        self
    }

    pub(super) fn finer_light(self) -> Self {
        Self {
            light: (self.light * 3).div_ceil(2),
            ..self
        }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "not negative; beyond a thousand it is cut down"
)]
pub(super) fn whole(x: f64) -> usize {
    x.ceil().min(1e3) as usize
}
