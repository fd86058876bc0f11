//! Finds the primitives that end rays on a leg.

use crate::line::{direction, start};
use crate::primitive::Primitive;
use etendue_bvh::BinaryHierarchy;
use etendue_field::TwoPlane;
use glam::DVec3;

/// A primitive that ends a ray, with a tag that identifies it.
#[derive(Clone, Debug)]
pub(crate) struct TaggedPrimitive<T> {
    pub(crate) primitive: Primitive,
    pub(crate) tag: T,
}

/// A primitive that a ray meets, and the number of the part that the ray meets.
#[derive(Debug)]
pub(crate) struct PrimitiveHit<'a, T> {
    primitive: &'a Primitive,
    part: usize,
    pub(crate) tag: &'a T,
}

/// Primitives, and a hierarchy that finds the first primitive that a ray hits.
#[derive(Debug)]
pub(crate) struct PrimitiveSet<T> {
    hierarchy: BinaryHierarchy,
    /// The primitives in the order of the hierarchy's leaves.
    primitives: Vec<TaggedPrimitive<T>>,
}

/// Up to this number, primitives are tested one after another without a hierarchy, because these
/// tests are as fast as the start of a traversal.
const MAX_TRIED_IN_TURN: usize = 4;

impl<T> TaggedPrimitive<T> {
    pub(crate) fn met(&self, part: usize) -> PrimitiveHit<'_, T> {
        let Self { primitive, tag } = self;
        PrimitiveHit {
            primitive,
            part,
            tag,
        }
    }
}

impl<T> Clone for PrimitiveHit<'_, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for PrimitiveHit<'_, T> {}

impl<T> PrimitiveHit<'_, T> {
    /// The unit normal at the hit.
    pub(crate) fn normal(&self, point: DVec3) -> DVec3 {
        self.primitive.normal(self.part, point)
    }

    /// The normal of the triangle's plane at a hit on a mesh.
    pub(crate) fn facet_normal(&self) -> Option<DVec3> {
        self.primitive.facet_normal(self.part)
    }
}

impl<T: Clone> PrimitiveSet<T> {
    /// Builds the set; `origins` is the largest coordinate of the starting point of any ray.
    pub(crate) fn new(primitives: &[TaggedPrimitive<T>], origins: f64) -> Self {
        let bounds: Vec<_> = primitives
            .iter()
            .map(|primitive| primitive.primitive.bounds())
            .collect();
        let hierarchy = BinaryHierarchy::new(bounds.len(), origins, |i| bounds[i]);
        let order = hierarchy.order().iter();
        let primitives = order.map(|i| primitives[*i as usize].clone()).collect();
        Self {
            hierarchy,
            primitives,
        }
    }

    /// All primitives.
    pub(crate) fn primitives(&self) -> &[TaggedPrimitive<T>] {
        &self.primitives
    }

    /// The first primitive that a ray meets beyond `from`, and the distance of the hit.
    #[inline]
    pub(crate) fn closest_hit(
        &self,
        ray: &TwoPlane,
        from: f64,
    ) -> Option<(f64, PrimitiveHit<'_, T>)> {
        let mut first = None;
        let mut nearest = f64::INFINITY;
        let mut try_one = |i: usize| {
            let primitive: &TaggedPrimitive<T> = &self.primitives[i];
            if let Some((distance, part)) = primitive.primitive.closest_hit(ray, from, nearest)
                && distance < nearest
                && distance > from
            {
                nearest = distance;
                first = Some((primitive, part));
            }
            nearest
        };
        if self.primitives.len() <= MAX_TRIED_IN_TURN {
            (0..self.primitives.len()).for_each(|i| {
                try_one(i);
            });
        } else {
            let (start, direction) = (start(ray), direction(ray));
            self.hierarchy
                .along(start, direction, [from, f64::INFINITY], try_one);
        }
        first.map(|(primitive, part)| (nearest, primitive.met(part)))
    }

    /// The last primitive on the line of a ray before `until`, and the distance of the hit.
    /// The search goes backwards from `until`.
    pub(crate) fn last(&self, ray: &TwoPlane, until: f64) -> Option<(f64, PrimitiveHit<'_, T>)> {
        let mut last = None;
        let mut farthest = f64::NEG_INFINITY;
        let range = [-until, f64::INFINITY];
        let (start, back) = (start(ray), -direction(ray));
        self.hierarchy.along(start, back, range, |i| {
            let primitive = &self.primitives[i];
            if let Some((distance, part)) = primitive.primitive.last(ray, until)
                && distance > farthest
            {
                farthest = distance;
                last = Some((primitive, part));
            }
            -farthest
        });
        last.map(|(primitive, part)| (farthest, primitive.met(part)))
    }

    /// Calls `tell` with every primitive on the line of a ray and the distance of the hit.
    pub(crate) fn each(&self, ray: &TwoPlane, mut tell: impl FnMut(f64, PrimitiveHit<'_, T>)) {
        let range = [f64::NEG_INFINITY, f64::INFINITY];
        let (start, direction) = (start(ray), direction(ray));
        self.hierarchy.along(start, direction, range, |i| {
            let tagged = &self.primitives[i];
            let primitive = &tagged.primitive;
            primitive.each(ray, |distance, part| tell(distance, tagged.met(part)));
            f64::INFINITY
        });
    }

    /// Checks whether light on a ray meets a primitive between `from` and `distance`. If
    /// `inclusive`, a hit exactly at `distance` counts. The search goes backwards from `distance`
    /// and skips primitives that `ignored` accepts.
    pub(crate) fn is_occluded(
        &self,
        ray: &TwoPlane,
        from: f64,
        distance: f64,
        inclusive: bool,
        ignored: impl Fn(&T) -> bool,
    ) -> bool {
        let does = |at: f64| at > from && (at < distance || inclusive && at <= distance);
        let mut blocked = false;
        let (start, back) = (start(ray), -direction(ray));
        self.hierarchy.along(start, back, [-distance, -from], |i| {
            let TaggedPrimitive { primitive, tag } = &self.primitives[i];
            blocked |= !ignored(tag) && primitive.is_occluded(ray, [from, distance], does);
            // The search ends after the first hit.
            if blocked { f64::NEG_INFINITY } else { -from }
        });
        blocked
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::BlockerMesh;
    use etendue_field::{Disc, Frame, Rectangle, Shape};
    use etendue_scene::Triangles;
    use etendue_transform::random::{self, Stream};

    fn mesh(triangles: Vec<[DVec3; 3]>) -> Primitive {
        let triangles = Triangles::new(triangles, 0.0);
        Primitive::Mesh(Box::new(BlockerMesh::new(
            &triangles,
            None,
            Frame::IDENTITY,
        )))
    }

    /// Returns discs, triangles, and squares that share edges. With such primitives, rounding
    /// errors could let rays through.
    fn primitives(scale: f64) -> Vec<TaggedPrimitive<u32>> {
        let mut primitives = Vec::new();
        for layer in 1..4u32 {
            for i in 0..20u32 {
                for j in (layer % 2..20).step_by(2) {
                    let center = [i, j].map(|i| (0.1 * f64::from(i) - 1.0) * scale);
                    let shape = if layer == 2 {
                        let radius = 0.05 * scale;
                        Shape::Disc(Disc { center, radius })
                    } else {
                        let size = [0.1 * scale; 2];
                        Shape::Rectangle(Rectangle { center, size })
                    };
                    let distance = f64::from(layer) * scale;
                    primitives.push(Primitive::Flat { distance, shape });
                }
            }
        }
        let corner = |i: u32| {
            let t = 0.7 * f64::from(i);
            scale
                * DVec3::new(
                    libm::sin(t),
                    libm::cos(1.3 * t),
                    1.5 + 0.4 * libm::sin(2.9 * t),
                )
        };
        let triangle = |i| [corner(i), corner(i + 1), corner(i + 2)];
        primitives.extend((0..30).map(|i| mesh(vec![triangle(i)])));
        primitives.push(mesh((30..60).map(triangle).collect()));
        primitives.extend((0..40).map(|i| {
            let d = corner(i) - DVec3::new(0.0, 0.0, scale);
            let shape = Shape::Disc(Disc {
                center: [0.02 * scale, -0.01 * scale],
                radius: 0.1 * scale,
            });
            let frame = Frame::new(corner(i + 3), d, DVec3::X).unwrap_or(Frame::IDENTITY);
            let frame = Box::new(frame);
            Primitive::Oblique { frame, shape }
        }));
        let tags = 0u32..;
        let tagged = primitives.into_iter().zip(tags);
        tagged
            .map(|(primitive, tag)| TaggedPrimitive { primitive, tag })
            .collect()
    }

    /// The hits of a ray with primitives beyond the ray's origin, found by a test of
    /// every primitive without a hierarchy.
    fn in_turn(all: &[TaggedPrimitive<u32>], ray: &TwoPlane) -> Vec<f64> {
        let met = all.iter().flat_map(|primitive| match &primitive.primitive {
            Primitive::Mesh(mesh) => mesh.in_turn(ray),
            primitive => primitive
                .closest_hit(ray, 0.0, f64::INFINITY)
                .into_iter()
                .collect(),
        });
        met.map(|(at, _)| at).collect()
    }

    #[test]
    fn agrees_with_every_target_tried_in_turn() {
        for scale in [1e-30, 1e-3, 1.0, 1e3, 1e30] {
            let all = primitives(scale);
            let found = PrimitiveSet::new(&all, 0.5 * scale);
            let (mut hits, mut blocked) = (0, 0);
            for index in 0..20_000 {
                let w = random::words(3, Stream::Photon, index, 0).map(|w| random::unit(w) - 0.5);
                let ray = TwoPlane {
                    x: w[0] * scale,
                    y: w[1] * scale,
                    u: w[2],
                    v: w[3],
                };
                let met = in_turn(&all, &ray);
                let expected = met.iter().copied().fold(f64::INFINITY, f64::min);
                let first = found
                    .closest_hit(&ray, 0.0)
                    .map_or(f64::INFINITY, |(at, _)| at);
                assert!(
                    first.total_cmp(&expected).is_eq(),
                    "{ray:?} at scale {scale}"
                );
                hits += u32::from(first.is_finite());
                let farthest = met.into_iter().fold(f64::NEG_INFINITY, f64::max);
                let last = found
                    .last(&ray, f64::INFINITY)
                    .map_or(f64::NEG_INFINITY, |(at, _)| at);
                assert!(last.total_cmp(&farthest).is_eq(), "{ray:?}: last");
                for (distance, inclusive) in [(1.0, false), (1.0, true), (1.6, true), (2.0, false)]
                {
                    let distance = distance * scale;
                    let expected = expected < distance || inclusive && expected <= distance;
                    let blocks = found.is_occluded(&ray, 0.0, distance, inclusive, |_| false);
                    assert_eq!(blocks, expected, "{ray:?} to {distance}");
                    blocked += u32::from(blocks);
                }
            }
            assert!(hits > 10_000, "{hits} rays hit: too few to tell");
            assert!((10_000..70_000).contains(&blocked), "{blocked} of 80,000");
        }
    }

    /// Invalid primitives, which no valid scene has, are not passed to the builder of the
    /// hierarchy, and rays still find the valid primitives beside them.
    #[test]
    fn forms_without_a_box_are_candidates_everywhere() {
        for bad in [f64::NAN, f64::INFINITY, 1e300] {
            let mut all = primitives(1.0);
            let strange = mesh(vec![[DVec3::splat(bad); 3]]);
            all.extend((0..50).map(|tag| TaggedPrimitive {
                primitive: strange.clone(),
                tag,
            }));
            let found = PrimitiveSet::new(&all, 0.5);
            let straight = TwoPlane::default();
            assert!(found.closest_hit(&straight, 0.0).is_some(), "{bad}");
        }
    }
}
