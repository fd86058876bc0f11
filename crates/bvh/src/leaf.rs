//! Tests a few triangles together in f32, to find the triangles that a ray may meet.
//!
//! As seen along the ray, a triangle is hit if the ray is on the same side of all three edges
//! (Woop, Benthin and Wald 2013, *Watertight ray/triangle intersection*). A triangle is rejected
//! only if the ray is on different sides of the triangle's edges by more than all rounding
//! errors. A box in a leaf is a triangle with NaN corners, which is never rejected.

use crate::space::single;
use crate::wide::Visit;
use fearless_simd::{Simd, f32x4, prelude::*};
use glam::{DVec3, Vec3A};

/// The largest number of primitives in a leaf.
pub(crate) const MAX_LEAF: usize = 4;

/// A vector with one number for each triangle of a leaf.
type Lanes<S> = f32x4<S>;

#[derive(Clone)]
pub(crate) struct Leaf {
    /// Corners [corner, axis, triangle], scaled such that the largest coordinate of all triangles
    /// is 1.
    corners: [[[f32; MAX_LEAF]; 3]; 3],
    first: u32,
    count: u32,
}

/// A ray with its direction scaled to (x, y, 1) in permuted axes.
pub(crate) struct LeafRay {
    origin: [f32; 3],
    axes: [usize; 3],
    slopes: [f32; 2],
    /// Bound on the error of coordinates across the ray. The rounding errors of corners, origin
    /// and slopes contribute 4e-6.
    tolerance: f32,
}

impl LeafRay {
    #[inline]
    pub(crate) fn new(origin: Vec3A, direction: DVec3, tolerance: f32) -> Self {
        let size = direction.abs();
        // The axes are permuted so that the largest component of the direction comes last; this
        // component is scaled to 1.
        let axes = if size.x > size.y && size.x > size.z {
            [1, 2, 0]
        } else if size.y > size.z {
            [2, 0, 1]
        } else {
            [0, 1, 2]
        };
        let [x, y, z] = axes.map(|axis| direction[axis]);
        Self {
            origin: origin.to_array(),
            axes,
            slopes: [single(x / z), single(y / z)],
            tolerance,
        }
    }
}

impl Leaf {
    pub(crate) fn new(first: u32, triangles: impl Iterator<Item = [Vec3A; 3]>) -> Self {
        let mut corners = [[[0.0; MAX_LEAF]; 3]; 3];
        let mut count = 0;
        for (i, triangle) in triangles.enumerate() {
            for (corner, place) in triangle.iter().enumerate() {
                for axis in 0..3 {
                    corners[corner][axis][i] = place[axis];
                }
            }
            count += 1;
        }
        Self {
            corners,
            first,
            count,
        }
    }

    /// The triangles that a ray may meet, as a mask with one bit for each triangle.
    #[inline(always)]
    fn candidates<S: Simd>(&self, simd: S, sight: &LeafRay) -> u32 {
        let a = self.across(simd, sight, 0);
        let b = self.across(simd, sight, 1);
        let c = self.across(simd, sight, 2);
        let [u, v, w] = [side(b, c), side(c, a), side(a, b)];
        // A bound on the error of each product, due to the errors of the two coordinates.
        let size = size(a) + size(b) + size(c) + 2.0 * sight.tolerance;
        let error = size * sight.tolerance;
        // Comparisons with NaN are false, so NaN does not lead to rejection.
        let out = u.min(v).min(w).simd_lt(-error) & u.max(v).max(w).simd_gt(error);
        !u32::try_from(out.to_bitmask()).unwrap_or_default() & ((1 << self.count) - 1)
    }

    /// The position of a corner of each triangle across the ray.
    #[inline(always)]
    fn across<S: Simd>(&self, simd: S, sight: &LeafRay, corner: usize) -> [Lanes<S>; 2] {
        let [x, y, z] = sight.axes;
        let corner = &self.corners[corner];
        let z = Lanes::simd_from(simd, corner[z]) - sight.origin[z];
        let x = Lanes::simd_from(simd, corner[x]) - sight.origin[x];
        let y = Lanes::simd_from(simd, corner[y]) - sight.origin[y];
        [x - z * sight.slopes[0], y - z * sight.slopes[1]]
    }
}

/// Returns which side of an edge the ray is on.
#[inline(always)]
fn side<S: Simd>(p: [Lanes<S>; 2], q: [Lanes<S>; 2]) -> Lanes<S> {
    p[0] * q[1] - p[1] * q[0]
}

#[inline(always)]
fn size<S: Simd>(p: [Lanes<S>; 2]) -> Lanes<S> {
    p[0].abs() + p[1].abs()
}

/// The leaves of a tree. Each visit passes to the caller the primitives that a ray may meet.
pub(crate) struct Leaves<'a, M> {
    pub(crate) leaves: &'a [Leaf],
    pub(crate) sight: LeafRay,
    pub(crate) meet: M,
}

impl<M: FnMut(usize) -> f32> Visit for Leaves<'_, M> {
    #[inline(always)]
    fn visit<S: Simd>(&mut self, simd: S, leaf: usize) -> f32 {
        let leaf = &self.leaves[leaf];
        let mut left = leaf.candidates(simd, &self.sight);
        let mut until = f32::INFINITY;
        while left != 0 {
            let i = leaf.first + left.trailing_zeros();
            left &= left - 1;
            until = until.min((self.meet)(i as usize));
        }
        until
    }
}
