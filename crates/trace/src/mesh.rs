//! Intersects the rays of a leg with a mesh.
//!
//! The triangles stay in the frame at the light, with one hierarchy over all triangles, and rays
//! are transformed to that frame. Each hit is decided in the frame of the leg, in which a direction
//! is (u, v, 1). For two triangles that share an edge, the computation in this frame uses the same
//! arithmetic for the edge.

use crate::line::{direction, start};
use etendue_bvh::SearchMemory;
use etendue_field::{Frame, TwoPlane, box_corners, enclosing, interpolated_normal};
use etendue_field::{triangle_distance, triangle_is_met};
use etendue_scene::Triangles;
use glam::DVec3;
use std::cmp::Reverse;
use std::sync::Arc;

/// A mesh in the coordinates of one leg of the path.
#[derive(Clone, Debug)]
pub(crate) struct BlockerMesh {
    triangles: Triangles,
    /// Normals at the corners of a smooth mesh.
    normals: Option<Arc<[[DVec3; 3]]>>,
    /// The frame of the leg; `None` if it is the frame at the light.
    leg: Option<Frame>,
}

impl BlockerMesh {
    pub(crate) fn new(
        triangles: &Triangles,
        normals: Option<&Arc<[[DVec3; 3]]>>,
        leg: Frame,
    ) -> Self {
        Self {
            triangles: triangles.clone(),
            normals: normals.cloned(),
            leg: (leg != Frame::IDENTITY).then_some(leg),
        }
    }

    /// The first triangle that a ray meets beyond `from`, and the distance of this
    /// triangle. Among triangles at the same distance, the triangle with the lowest number is
    /// returned. Hits beyond `until` may be ignored.
    pub(crate) fn closest_hit(
        &self,
        ray: &TwoPlane,
        from: f64,
        until: f64,
    ) -> Option<(f64, usize)> {
        let mut first: Option<(f64, usize)> = None;
        self.along(ray, 1.0, [from, until], |at, i| {
            if at > from && first.is_none_or(|first| (at, i) < first) {
                first = Some((at, i));
            }
            first.map_or(until, |(at, _)| at)
        });
        first
    }

    /// The last triangle on the line of a ray before `until`. Among triangles at the same
    /// distance, the triangle with the lowest number is returned.
    pub(crate) fn last(&self, ray: &TwoPlane, until: f64) -> Option<(f64, usize)> {
        let mut last: Option<(f64, Reverse<usize>)> = None;
        self.along(ray, -1.0, [until, f64::NEG_INFINITY], |at, i| {
            let found = (at, Reverse(i));
            if at < until && last.is_none_or(|last| found > last) {
                last = Some(found);
            }
            last.map_or(f64::NEG_INFINITY, |(at, _)| at)
        });
        last.map(|(at, Reverse(i))| (at, i))
    }

    /// Checks whether a ray meets a triangle between `from` and `distance`. Only distances for
    /// which `does` returns true count. The search goes backwards from `distance`.
    pub(crate) fn is_occluded(
        &self,
        ray: &TwoPlane,
        [from, distance]: [f64; 2],
        does: impl Fn(f64) -> bool,
    ) -> bool {
        let mut blocked = false;
        self.along(ray, -1.0, [distance, from], |at, _| {
            blocked |= does(at);
            // The search ends after the first hit.
            if blocked { f64::INFINITY } else { from }
        });
        blocked
    }

    /// Checks whether a ray meets any triangle beyond the beginning of the leg. The mesh lies
    /// beyond the beginning, and its frame is the frame at the light ([`Self::extent`]).
    pub(crate) fn is_met(&self, memory: &mut SearchMemory, ray: &TwoPlane) -> bool {
        let triangles = &self.triangles;
        triangles.any(memory, start(ray), direction(ray), 0.0, |i| {
            triangle_is_met(&triangles[i], ray)
        })
    }

    /// The distances of the nearest and the farthest point, if the mesh lies beyond the
    /// beginning of a leg whose frame is the frame at the light.
    pub(crate) fn extent(&self) -> Option<[f64; 2]> {
        let [low, high] = self.triangles.bounds();
        (self.leg.is_none() && low.z > 0.0).then_some([low.z, high.z])
    }

    /// Calls `tell` with the distance and number of every triangle on the line of a ray.
    pub(crate) fn each(&self, ray: &TwoPlane, mut tell: impl FnMut(f64, usize)) {
        self.along(ray, 1.0, [f64::NEG_INFINITY, f64::INFINITY], |at, i| {
            tell(at, i);
            f64::INFINITY
        });
    }

    /// Visits triangles along a ray, forwards if `way` is 1 and backwards if it is −1. `meet`
    /// returns the distance beyond which triangles can be skipped.
    #[inline]
    fn along(
        &self,
        ray: &TwoPlane,
        way: f64,
        range: [f64; 2],
        mut meet: impl FnMut(f64, usize) -> f64,
    ) {
        let (mut start, mut direction) = (start(ray), direction(ray));
        if let Some(leg) = &self.leg {
            (start, direction) = (leg.to_world(start), leg.vector_to_world(direction));
        }
        let mut matters = range[1];
        let range = range.map(|at| way * at);
        self.triangles.along(start, way * direction, range, |i| {
            if let Some(at) = triangle_distance(&self.corners(i), ray) {
                matters = meet(at, i);
            }
            way * matters
        });
    }

    /// The corners of a triangle, in the frame of the leg.
    #[inline]
    fn corners(&self, i: usize) -> [DVec3; 3] {
        let corners = self.triangles[i];
        match &self.leg {
            None => corners,
            Some(leg) => corners.map(|p| leg.to_local(p)),
        }
    }

    /// The unit normal of the plane of a triangle.
    pub(crate) fn facet_normal(&self, i: usize) -> DVec3 {
        let [a, b, c] = self.corners(i);
        (b - a).cross(c - a).normalize()
    }

    /// The unit normal at a point of a triangle.
    pub(crate) fn normal(&self, i: usize, point: DVec3) -> DVec3 {
        let Some(normals) = &self.normals else {
            return self.facet_normal(i);
        };
        let leg = self.leg.unwrap_or(Frame::IDENTITY);
        let normals = normals[i].map(|n| leg.vector_to_local(n));
        interpolated_normal(&self.corners(i), &normals, point)
    }

    /// All hits on the line of a ray, found by a test of every triangle without a
    /// hierarchy.
    #[cfg(test)]
    pub(crate) fn in_turn(&self, ray: &TwoPlane) -> Vec<(f64, usize)> {
        let numbers = 0..self.triangles.len();
        let hits = numbers.filter_map(|i| Some((triangle_distance(&self.corners(i), ray)?, i)));
        hits.collect()
    }

    /// The lowest and the highest corner of the mesh's bounding box.
    pub(crate) fn bounds(&self) -> [DVec3; 2] {
        let [low, high] = self.triangles.bounds();
        match &self.leg {
            None => [low, high],
            Some(leg) => enclosing(&box_corners(low, high).map(|p| leg.to_local(p))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_transform::random::{self, Stream};

    /// The frames of two legs: one that begins far from the light, and one that begins at
    /// the light.
    fn legs() -> [Frame; 2] {
        let [origin, d] = [DVec3::new(3.0, -1.0, 2.5), DVec3::new(-3.0, 1.2, -1.4)];
        [
            Frame::IDENTITY,
            Frame::new(origin, d, DVec3::X).unwrap_or(Frame::IDENTITY),
        ]
    }

    /// A wavy sheet of 2n² triangles around (0, 0, 1).
    fn sheet(n: u32) -> Triangles {
        let corner = |i: u32, j: u32| {
            let [x, y] = [i, j].map(|k| f64::from(k) / f64::from(n) * 2.0 - 1.0);
            DVec3::new(x, y, 1.0 + 0.1 * libm::sin(7.0 * x) * libm::cos(5.0 * y))
        };
        let mut sheet = Vec::new();
        for i in 0..n {
            for j in 0..n {
                let [a, b, c, d] =
                    [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| corner(i, j));
                sheet.extend([[a, b, c], [a, c, d]]);
            }
        }
        Triangles::new(sheet, 0.5)
    }

    /// The ray of a leg that passes through two points given in the frame at the light.
    fn ray(leg: &Frame, from: DVec3, to: DVec3) -> TwoPlane {
        let [from, to] = [from, to].map(|p| leg.to_local(p));
        let [u, v] = [0, 1].map(|axis| (to - from)[axis] / (to - from).z);
        TwoPlane {
            x: from.x - u * from.z,
            y: from.y - v * from.z,
            u,
            v,
        }
    }

    /// A hierarchy, built in one part or in several, gives the same hits as a test of every
    /// triangle.
    #[test]
    fn agrees_with_every_triangle_tried_in_turn() {
        for (n, rays) in [(16, 5000), (200, 200)] {
            let triangles = sheet(n);
            let mut memory = SearchMemory::default();
            for leg in legs() {
                let mesh = BlockerMesh::new(&triangles, None, leg);
                let (mut hits, mut misses) = (0, 0);
                for index in 0..rays {
                    let r = |block| {
                        let words = random::words(5, Stream::Photon, index, block);
                        let [x, y, z, _] = words.map(|w| random::unit(w) - 0.5);
                        DVec3::new(2.2 * x, 2.2 * y, 1.0 + 0.3 * z)
                    };
                    let ray = ray(&leg, r(0), r(1));
                    let all = mesh.in_turn(&ray);
                    let by = |a: &(f64, usize), b: &(f64, usize)| a.0.total_cmp(&b.0);
                    assert_eq!(
                        mesh.last(&ray, f64::INFINITY),
                        all.iter().copied().max_by(by),
                        "{ray:?}"
                    );
                    let mut told = Vec::new();
                    mesh.each(&ray, |at, i| told.push((at, i)));
                    told.sort_by_key(|(_, i)| *i);
                    assert_eq!(told, all, "{ray:?}");
                    let half = 0.5 * (leg.to_local(r(0)).z + leg.to_local(r(1)).z);
                    let beyond = all.iter().copied().filter(|(at, _)| *at > half);
                    let expected = beyond.min_by(by);
                    let first = mesh.closest_hit(&ray, half, f64::INFINITY);
                    assert_eq!(first, expected, "{ray:?}");
                    let end = half + 0.2;
                    let blocks = mesh.is_occluded(&ray, [half, end], |at| at > half && at < end);
                    assert_eq!(blocks, expected.is_some_and(|(at, _)| at < end), "{ray:?}");
                    if mesh.extent().is_some() {
                        let is_met = mesh.is_met(&mut memory, &ray);
                        assert_eq!(is_met, !all.is_empty(), "{ray:?}");
                    }
                    hits += u64::from(expected.is_some());
                    misses += u64::from(all.is_empty());
                }
                assert!(hits > rays / 10, "{hits}: too few to tell");
                assert!(misses > rays / 100, "{misses}: too few to tell");
            }
        }
    }

    /// Rays at the common edges and corners of a sheet of triangles never pass through the sheet.
    #[test]
    fn triangles_that_share_edges_leak_nothing() {
        const N: u32 = 16;
        let triangles = sheet(N);
        for leg in legs() {
            let mesh = BlockerMesh::new(&triangles, None, leg);
            for i in 1..N - 1 {
                for j in 1..N - 1 {
                    let (x, y) = (0.013 * f64::from(i), -0.017 * f64::from(j));
                    // The tested points are corners that four squares share, and points on the edge
                    // between two such corners.
                    let [p, _, end] = triangles[(2 * (i * N + j)) as usize];
                    for t in [0.0, 0.3, 0.5, 1.0] {
                        let ray = ray(&leg, DVec3::new(x, y, 0.0), p.lerp(end, t));
                        let first = mesh.closest_hit(&ray, f64::NEG_INFINITY, f64::INFINITY);
                        assert!(first.is_some(), "{ray:?}");
                    }
                }
            }
        }
    }
}
