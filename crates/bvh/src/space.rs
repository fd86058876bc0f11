//! Converts boxes to f32, and pads them.

use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::ploc::morton::morton_encode_u64_unorm;

/// The coordinates of boxes in f32, relative to the centre of all boxes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Space {
    center: DVec3,
    /// The largest coordinate relative to the centre.
    size: f64,
    /// The padding of boxes.
    pub(crate) padding: f64,
    /// The factor that scales coordinates to at most about 1, as `leaf` needs them.
    pub(crate) unit: f64,
}

/// The part of a ray over which boxes are traversed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stretch {
    /// The distance along the ray at which the traversal begins.
    pub(crate) begin: f64,
    /// The point at this distance, relative to the centre of all boxes.
    pub(crate) origin: DVec3,
    /// The distance from this point beyond which boxes can be skipped.
    pub(crate) until: f32,
}

/// Padding relative to `Space::size`. A rounding error in f32 is 6e-8 of the size, and each ray
/// adds a few rounding errors.
const PADDING: f64 = 1e-5;

/// Additional padding relative to the largest coordinate at which a ray begins. It is several
/// rounding errors in f64.
const ROUNDING: f64 = 1e-13;

/// The largest coordinate of a box; the largest number in f32 is some 300 times as large. The
/// coordinates of patches in valid scenes are at most 1e28.
const MAX_EXTENT: f64 = 1e36;

impl Space {
    pub(crate) fn around(boxes: impl Iterator<Item = [DVec3; 2]>, origins: f64) -> Self {
        let sound = boxes.filter(|of| is_sound(of, MAX_EXTENT));
        let all = sound.reduce(|[a, b], [low, high]| [a.min(low), b.max(high)]);
        let [low, high] = all.unwrap_or_default();
        let center = 0.5 * low + 0.5 * high;
        let size = (high - center).max(center - low).max_element();
        let farthest = (center.abs().max_element() + size + origins).min(MAX_EXTENT);
        Self {
            center,
            size,
            padding: PADDING * size + ROUNDING * farthest,
            // If the size is zero, or its reciprocal is not finite in f64, all triangles are
            // candidates.
            unit: 1.0 / size,
        }
    }

    /// The padded box.
    pub(crate) fn padded(&self, [low, high]: [DVec3; 2]) -> Aabb {
        let (low, high) = (
            low - self.center - self.padding,
            high - self.center + self.padding,
        );
        if is_sound(&[low, high], 2.0 * MAX_EXTENT) {
            Aabb::new(vector(low), vector(high))
        } else {
            let everywhere = DVec3::splat(self.size + self.padding);
            Aabb::new(vector(-everywhere), vector(everywhere))
        }
    }

    /// A point in the coordinates of triangles in leaves.
    pub(crate) fn scaled(&self, place: DVec3) -> Vec3A {
        vector(self.unit * (place - self.center))
    }

    /// The position of the centre of a box on a space-filling curve.
    pub(crate) fn place(&self, [low, high]: [DVec3; 2]) -> u64 {
        let middle = 0.5 * (low + high) - self.center;
        // The coordinates are in the range from 0 to below 1.
        morton_encode_u64_unorm(0.5 + 0.49 * middle / self.size)
    }

    /// The distance along a ray at which the traversal begins. This is usually the distance
    /// `from`. If the point at `from` is far from all boxes, the traversal begins where the ray
    /// comes near the boxes, because f32 would lose precision over a longer distance.
    #[inline(always)]
    fn begin(&self, start: DVec3, direction: DVec3, from: f64) -> f64 {
        let start = start - self.center;
        let at = start + from * direction;
        if at.abs().max_element() < 4.0 * self.size {
            return from;
        }
        let comes_near = |at: f64, d: f64| (-at - (2.0 * self.size).copysign(d)) / d;
        let near = [0, 1, 2].map(|axis| comes_near(start[axis], direction[axis]));
        // Axes with NaN or infinite distances are ignored, because the ray does not come nearer
        // to the boxes along these axes.
        let near = near.into_iter().filter(|t| t.is_finite());
        near.fold(from, f64::max)
    }

    /// Returns where the traversal of a ray begins and ends. The ray begins at `from`, and before
    /// the first hit it ends at `until`.
    #[inline(always)]
    pub(crate) fn stretch(
        &self,
        start: DVec3,
        direction: DVec3,
        [from, until]: [f64; 2],
    ) -> Stretch {
        let begin = self.begin(start, direction, from);
        Stretch {
            begin,
            origin: start + begin * direction - self.center,
            until: self.limit(until, begin),
        }
    }

    /// A distance in f32, counted from `begin`. If all boxes up to this distance are
    /// opened, no box up to `at` is missed. The caller computes intersections in f64.
    #[inline]
    pub(crate) fn limit(&self, at: f64, begin: f64) -> f32 {
        single((at - begin) * (1.0 + PADDING) + self.padding)
    }
}

fn is_sound(corners: &[DVec3; 2], largest: f64) -> bool {
    let within = |p: &DVec3| p.is_finite() && p.abs().max_element() <= largest;
    corners.iter().all(within)
}

#[inline]
pub(crate) fn vector(v: DVec3) -> Vec3A {
    Vec3A::new(single(v.x), single(v.y), single(v.z))
}

/// A number in single precision, to find candidates.
#[inline]
#[expect(
    clippy::cast_possible_truncation,
    reason = "f32 is used only to find candidates, and padding covers its rounding errors"
)]
pub(crate) fn single(x: f64) -> f32 {
    x as f32
}
