//! Intersects rays with triangles, without gaps at shared edges.

use glam::{DVec2, DVec3};

/// A ray prepared for triangle tests. The axes are permuted and scaled to give the ray the
/// direction (x, y, 1).
pub(super) struct TriangleRay {
    pub(super) start: DVec3,
    /// The axis along which the component of the direction is largest. This axis becomes the last
    /// axis.
    last: usize,
    pub(super) slopes: DVec2,
    /// The ratio of distances along the ray to depths along the last axis.
    pub(super) per_depth: f64,
}

impl TriangleRay {
    #[inline]
    pub(super) fn new(start: DVec3, along: DVec3) -> Self {
        let last = along.abs().max_position();
        let along = turned(along, last);
        Self {
            start: turned(start, last),
            last,
            slopes: along.truncate() / along.z,
            per_depth: 1.0 / along.z,
        }
    }

    /// The permuted axes.
    #[inline]
    pub(super) fn axes(&self) -> [usize; 3] {
        [(self.last + 1) % 3, (self.last + 2) % 3, self.last]
    }

    /// The distance of the hit, and two of its barycentric coordinates, which belong to the
    /// second and the third corner (Woop, Benthin and Wald 2013, *Watertight ray/triangle
    /// intersection*). For a shared edge, both triangles compute the same number with opposite
    /// signs, so no ray passes between the triangles.
    #[inline]
    pub(super) fn meets(&self, corners: &[DVec3; 3]) -> Option<(f64, DVec2)> {
        let seen = corners.map(|corner| turned(corner, self.last) - self.start);
        let [a, b, c] = seen.map(|p| p.truncate() - p.z * self.slopes);
        let sides = DVec3::new(b.perp_dot(c), c.perp_dot(a), a.perp_dot(b));
        let volume = sides.element_sum();
        // A triangle that has no area, is parallel to the ray or has NaN coordinates is not hit.
        let is_met = (sides.min_element() >= 0.0 || sides.max_element() <= 0.0) && volume != 0.0;
        let weights = sides / volume;
        let depths = DVec3::new(seen[0].z, seen[1].z, seen[2].z);
        is_met.then(|| {
            (
                self.per_depth * weights.dot(depths),
                DVec2::new(weights.y, weights.z),
            )
        })
    }
}

/// Permutes the axes to put the given axis last.
#[inline]
fn turned(v: DVec3, last: usize) -> DVec3 {
    match last {
        0 => DVec3::new(v.y, v.z, v.x),
        1 => DVec3::new(v.z, v.x, v.y),
        _ => v,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_transform::random::{self, Stream};

    fn numbers(index: u64, block: u32) -> DVec3 {
        let [x, y, z, _] = random::words(1, Stream::Photon, index, block).map(random::unit);
        2.0 * DVec3::new(x, y, z) - 1.0
    }

    /// Rays at the shared edge of two triangles hit one of them.
    #[test]
    fn nothing_passes_between_triangles_that_share_an_edge() {
        let mut on_edge = 0;
        for index in 0..200_000 {
            let [a, b, aside, start] = [0, 1, 2, 3].map(|block| numbers(index, block));
            let place = a.lerp(b, 0.1 + 0.4 * (1.0 + numbers(index, 4).x));
            let (start, aside) = (4.0 * start, aside.cross(b - a));
            let sight = TriangleRay::new(start, (place - start).normalize());
            // The two triangles have a common edge. They list its two corners in opposite order.
            let [one, other] = [[a, b, place + aside], [b, a, place - aside]];
            let met = [sight.meets(&one), sight.meets(&other)];
            assert!(met.iter().any(Option::is_some), "{start} to {a}, {b}");
            on_edge += u32::from(met.iter().all(Option::is_some));
        }
        assert!(
            on_edge < 100_000,
            "{on_edge}: rays were not decided by rounding"
        );
    }

    #[test]
    fn distances_and_weights_lead_to_the_same_place() {
        for index in 0..10_000 {
            let corners = [0, 1, 2].map(|block| numbers(index, block));
            let [a, b, c] = corners;
            let start = 3.0 * numbers(index, 3);
            let weights = numbers(index, 4).abs();
            let [p, q] = [weights.x, weights.y].map(|w| 0.5 * w);
            let place = a + p * (b - a) + q * (c - a);
            let along = (place - start).normalize();
            let across = (b - a).cross(c - a).normalize().dot(along).abs();
            if across < 1e-3 {
                continue;
            }
            let (at, found) = TriangleRay::new(start, along)
                .meets(&corners)
                .expect("aimed at it");
            // Rounding errors are larger for grazing rays.
            assert!(
                (start + at * along - place).length() < 1e-14 / across,
                "{index}"
            );
            assert!((found - DVec2::new(p, q)).length() * (b - a).length() < 1e-12 / across);
        }
    }
}
