//! A hierarchy with eight boxes in a node over the triangles of one mesh, for photons.
//!
//! A leaf is the box of one triangle, so the hierarchy takes little memory, and the caller decides
//! every hit.

use crate::parts;
use crate::space::Space;
use crate::wide::{NodeRay, Wide};
use fearless_simd::{Level, dispatch};
use glam::DVec3;
use std::fmt;

/// A hierarchy over the boxes of triangles.
#[derive(Clone)]
pub struct MeshHierarchy {
    tree: Wide,
    space: Space,
    level: Level,
}

/// The memory of a search, which several searches use one after another.
#[derive(Clone, Debug, Default)]
pub struct SearchMemory(Vec<u32>);

impl MeshHierarchy {
    /// Builds a hierarchy over numbered boxes, given by their lowest and highest corners.
    /// `origins` is the largest coordinate of the starting points of rays.
    #[must_use]
    pub fn new(count: usize, origins: f64, bounds: impl Fn(usize) -> [DVec3; 2] + Sync) -> Self {
        let space = Space::around((0..count).map(&bounds), origins);
        Self {
            tree: parts::tree(count, &space, bounds),
            space,
            level: Level::new(),
        }
    }

    /// Visits the boxes that a ray may meet in a range of distances, approximately front to back.
    /// Distances are multiples of the length of `direction`, which is at least 1. `meet` receives
    /// the number of a box, and returns the distance beyond which boxes can be skipped. Before the
    /// first hit, this distance is the end of the range.
    #[inline]
    pub fn along(
        &self,
        start: DVec3,
        direction: DVec3,
        range: [f64; 2],
        mut meet: impl FnMut(usize) -> f64,
    ) {
        let stretch = self.space.stretch(start, direction, range);
        let ray = NodeRay::new(stretch, direction);
        let visit = |i: usize| self.space.limit(meet(i), stretch.begin);
        dispatch!(self.level, simd => self.tree.along(simd, &ray, visit));
    }

    /// Checks whether `meets` returns true for any box that a ray may meet beyond `from`.
    #[inline]
    pub fn any(
        &self,
        memory: &mut SearchMemory,
        start: DVec3,
        direction: DVec3,
        from: f64,
        meets: impl FnMut(usize) -> bool,
    ) -> bool {
        let range = [from, f64::INFINITY];
        let ray = NodeRay::new(self.space.stretch(start, direction, range), direction);
        let memory = &mut memory.0;
        dispatch!(self.level, simd => self.tree.any(simd, &ray, memory, meets))
    }
}

impl fmt::Debug for MeshHierarchy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MeshHierarchy").finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A source of numbers between 0 and 1.
    struct Draw(u64);

    impl Draw {
        fn unit(&mut self) -> f64 {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        }

        fn point(&mut self) -> DVec3 {
            DVec3::from_array([(); 3].map(|()| self.unit()))
        }
    }

    /// The distances along a ray between which the ray is in a box.
    fn inside(start: DVec3, direction: DVec3, [low, high]: [DVec3; 2]) -> [f64; 2] {
        let [a, b] = [(low - start) / direction, (high - start) / direction];
        [a.min(b).max_element(), a.max(b).min_element()]
    }

    /// Every box that a ray meets in f64 is among the candidates, for boxes built in one part and
    /// in several.
    #[test]
    fn misses_no_box_that_a_ray_meets() {
        for (count, size, rays) in [(1, 1.0, 2000), (300, 0.05, 2000), (70_000, 0.01, 40)] {
            let mut draw = Draw(count as u64);
            let mut boxes = Vec::new();
            for _ in 0..count {
                let low = draw.point();
                boxes.push([low, low + size * draw.point()]);
            }
            let hierarchy = MeshHierarchy::new(count, 3.0, |i| boxes[i]);
            let mut memory = SearchMemory::default();
            let mut met = 0;
            for _ in 0..rays {
                let start = 3.0 * draw.point() - DVec3::ONE;
                let direction = (draw.point() - start) * 4.0;
                let from = draw.unit() - 0.5;
                let meets = |i: usize| {
                    let [near, far] = inside(start, direction, boxes[i]);
                    near <= far && far >= from
                };
                let expected: Vec<usize> = (0..count).filter(|i| meets(*i)).collect();
                let mut found = Vec::new();
                hierarchy.along(start, direction, [from, f64::INFINITY], |i| {
                    found.extend(meets(i).then_some(i));
                    f64::INFINITY
                });
                found.sort_unstable();
                assert_eq!(found, expected);
                let mut found = Vec::new();
                hierarchy.any(&mut memory, start, direction, from, |i| {
                    found.extend(meets(i).then_some(i));
                    false
                });
                found.sort_unstable();
                assert_eq!(found, expected);
                let is_met = hierarchy.any(&mut memory, start, direction, from, meets);
                assert_eq!(is_met, !expected.is_empty());
                met += expected.len();
            }
            assert!(met > 10, "{met}: too few to tell");
        }
    }
}
