//! The only file that knows obvhs and f32.
//!
//! The hierarchy, in f32, only names candidates; whether and where a rectangle is hit is decided in f64.
//! Boxes are padded by more than f32 rounding, so no candidate is missed.
//!
//! The builder panics on boxes that are no numbers. No legal scene has them, and none reach it: what has no box in f32 is a candidate everywhere.

use crate::obstacles::{direction, start};
use etendue_field::{
    Frame, Patch, Shape, TwoPlane, enclosing, interpolated_normal, triangle_distance,
};
use glam::{DVec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::ray::{Ray, RayHit};
use std::fmt;
use std::time::Duration;

/// Something that ends a ray, and what it is.
#[derive(Clone, Debug)]
pub(crate) struct Target<T> {
    pub(crate) form: Form,
    pub(crate) tag: T,
}

/// Its form, in the frame of a leg. What is large is elsewhere: flat shapes, by far the most, are to stay in the processor's cache.
#[derive(Clone, Debug)]
pub(crate) enum Form {
    /// A flat shape across the central ray.
    Flat { distance: f64, shape: Shape },
    /// A flat shape in the plane of X and Y of a frame.
    Oblique { frame: Box<Frame>, shape: Shape },
    /// A triangle.
    Triangle([DVec3; 3]),
    /// A triangle of a smooth mesh, with the normals at its corners.
    Shaded {
        corners: [DVec3; 3],
        normals: Box<[DVec3; 3]>,
    },
    /// A smooth surface.
    Smooth(Box<Patch>),
}

impl Form {
    /// The distance, along the central ray, at which a ray meets it; where it can meet it twice, the first beyond `from`.
    #[inline]
    fn meets(&self, ray: &TwoPlane, from: f64) -> Option<f64> {
        if let Self::Flat { distance, shape } = self {
            let at = ray.travelled(*distance);
            return shape.contains(at.x, at.y).then_some(*distance);
        }
        self.meets_elsewhere(ray, from)
    }

    /// [`Self::meets`] of what is not flat: kept out of the loops that mostly meet flat shapes.
    #[inline(never)]
    fn meets_elsewhere(&self, ray: &TwoPlane, from: f64) -> Option<f64> {
        match self {
            Self::Flat { .. } => None,
            Self::Oblique { frame, shape } => {
                let (start, direction) = (start(ray), direction(ray));
                let distance = (frame.origin - start).dot(frame.d) / direction.dot(frame.d);
                let at = frame.to_local(start + distance * direction);
                (distance.is_finite() && shape.contains(at.x, at.y)).then_some(distance)
            }
            Self::Triangle(corners) | Self::Shaded { corners, .. } => {
                triangle_distance(corners, ray)
            }
            Self::Smooth(patch) => {
                let hits = smooth_hits(patch, ray);
                hits.into_iter().find(|at| *at > from)
            }
        }
    }

    /// The largest distance at which the line of a ray meets it.
    fn meets_last(&self, ray: &TwoPlane) -> Option<f64> {
        match self {
            Self::Smooth(patch) => smooth_hits(patch, ray)
                .into_iter()
                .rev()
                .find(|at| !at.is_nan()),
            _ => self.meets(ray, f64::NEG_INFINITY),
        }
    }

    /// The distances at which the line of a ray meets it; NaN where it does not.
    fn meets_at(&self, ray: &TwoPlane) -> [f64; 2] {
        match self {
            Self::Smooth(patch) => {
                // A line that meets it once has the same distance twice.
                let [first, last] = smooth_hits(patch, ray);
                [first, if last > first { last } else { f64::NAN }]
            }
            _ => {
                let at = self.meets(ray, f64::NEG_INFINITY);
                [at.unwrap_or(f64::NAN), f64::NAN]
            }
        }
    }

    /// A normal at a point of it, of unit length.
    pub(crate) fn normal(&self, point: DVec3) -> DVec3 {
        match self {
            Self::Flat { .. } => DVec3::Z,
            Self::Oblique { frame, .. } => frame.d,
            Self::Triangle([a, b, c]) => (b - a).cross(c - a).normalize(),
            Self::Shaded { corners, normals } => interpolated_normal(corners, normals, point),
            Self::Smooth(patch) => patch.normal(point),
        }
    }

    /// Lowest and highest corner of a box around it.
    fn bounds(&self) -> [DVec3; 2] {
        match self {
            Self::Flat { distance, shape } => {
                let bounds = shape.bounds();
                let [x, y] = [bounds.extent(0), bounds.extent(1)];
                [0, 1].map(|i| DVec3::new(x[i], y[i], *distance))
            }
            Self::Oblique { frame, shape } => {
                let bounds = shape.bounds();
                let [[left, right], [low, high]] = [bounds.extent(0), bounds.extent(1)];
                let corners = [[left, low], [right, low], [left, high], [right, high]]
                    .map(|[x, y]| frame.to_world(DVec3::new(x, y, 0.0)));
                enclosing(&corners)
            }
            Self::Triangle([a, b, c])
            | Self::Shaded {
                corners: [a, b, c], ..
            } => [a.min(*b).min(*c), a.max(*b).max(*c)],
            Self::Smooth(patch) => enclosing(&patch.corners()),
        }
    }
}

fn smooth_hits(patch: &Patch, ray: &TwoPlane) -> [f64; 2] {
    let frame = &patch.frame;
    patch.hits(
        frame.to_local(start(ray)),
        frame.vector_to_local(direction(ray)),
    )
}

/// Targets, and the hierarchy that finds the first one hit.
pub(crate) struct Targets<T> {
    bvh: Bvh2,
    /// In the order of the hierarchy's leaves.
    targets: Vec<Target<T>>,
    /// Beyond everything.
    far: f32,
    /// A distance along the leg beyond everything.
    front: f64,
}

impl<T: fmt::Debug> fmt::Debug for Targets<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Targets")
            .field("targets", &self.targets.len())
            .finish_non_exhaustive()
    }
}

/// Boxes grow by this share of the scene's extent: f32 rounding is 6e-8 of it, a ray adds a few of those.
const PADDING: f64 = 1e-5;

/// The largest coordinate of a box, which f32 still holds four times over. The farthest corner of a patch is at 1e28.
const LARGEST: f64 = 1e36;

impl<T: Clone> Targets<T> {
    /// `origins` is the largest coordinate a ray starts from.
    pub(crate) fn new(targets: &[Target<T>], origins: f64) -> Self {
        let extents = targets.iter().map(extent).filter(|at| *at <= LARGEST);
        let extent = extents.fold(origins, f64::max);
        let boxes: Vec<Aabb> = targets.iter().map(|t| padded(t, extent)).collect();
        // Without pre-splits: they are for triangles.
        let parameters = BvhBuildParams {
            pre_split: false,
            ..BvhBuildParams::very_slow_build()
        };
        let bvh = build_bvh2(&boxes, parameters, &mut Duration::default());
        let targets = bvh
            .primitive_indices
            .iter()
            .map(|i| targets[*i as usize].clone())
            .collect();
        Self {
            bvh,
            targets,
            far: single(4.0 * extent),
            front: 1.1 * extent,
        }
    }

    /// The first target that a ray meets beyond `from`, and at what distance.
    #[inline]
    pub(crate) fn first(&self, ray: &TwoPlane, from: f64) -> Option<(f64, &Target<T>)> {
        let begin = self.beside(ray, from, 1.0);
        let start = ray.travelled(begin);
        let origin = Vec3A::new(single(start.x), single(start.y), single(begin));
        let direction = Vec3A::new(single(ray.u), single(ray.v), 1.0);
        let mut first = None;
        let mut nearest = f64::INFINITY;
        self.bvh.ray_traverse(
            Ray::new(origin, direction, 0.0, self.far),
            &mut RayHit::none(),
            |_, i| {
                let target = &self.targets[i];
                match target.form.meets(ray, from) {
                    Some(distance) if distance < nearest && distance > from => {
                        nearest = distance;
                        first = Some(target);
                        // Boxes this far are still opened: the first hit is decided in f64.
                        single((distance - begin) * (1.0 + PADDING) + PADDING * distance.abs())
                    }
                    _ => f32::INFINITY,
                }
            },
        );
        first.map(|target| (nearest, target))
    }

    /// The last target on the line of a ray, and at what distance; looked for backwards, from beyond everything.
    pub(crate) fn last(&self, ray: &TwoPlane) -> Option<(f64, &Target<T>)> {
        let begin = self.beside(ray, self.front, -1.0);
        let end = ray.travelled(begin);
        let origin = Vec3A::new(single(end.x), single(end.y), single(begin));
        let direction = Vec3A::new(single(-ray.u), single(-ray.v), -1.0);
        let mut last: Option<(f64, &Target<T>)> = None;
        self.bvh.ray_traverse(
            Ray::new(origin, direction, 0.0, f32::MAX),
            &mut RayHit::none(),
            |_, i| {
                let target = &self.targets[i];
                match target.form.meets_last(ray) {
                    Some(at) if last.is_none_or(|(farthest, _)| at > farthest) => {
                        last = Some((at, target));
                        let back = begin - at;
                        single(back + PADDING * (back.abs() + at.abs()))
                    }
                    _ => f32::INFINITY,
                }
            },
        );
        last
    }

    /// Tells every target on the line of a ray, and at what distance.
    pub(crate) fn each(&self, ray: &TwoPlane, mut tell: impl FnMut(f64, &Target<T>)) {
        let begin = self.beside(ray, -self.front, 1.0);
        let start = ray.travelled(begin);
        let origin = Vec3A::new(single(start.x), single(start.y), single(begin));
        let direction = Vec3A::new(single(ray.u), single(ray.v), 1.0);
        self.bvh.ray_traverse(
            Ray::new(origin, direction, 0.0, f32::MAX),
            &mut RayHit::none(),
            |_, i| {
                let target = &self.targets[i];
                let hits = target.form.meets_at(ray).into_iter();
                hits.filter(|at| !at.is_nan())
                    .for_each(|at| tell(at, target));
                f32::INFINITY
            },
        );
    }

    /// Where to begin looking along a ray, forward or back (`way` 1 or −1): at `from`, or, if that is far to the side of everything, where it
    /// comes near; f32 would lose it on the way.
    fn beside(&self, ray: &TwoPlane, from: f64, way: f64) -> f64 {
        let at = ray.travelled(from);
        if at.x.abs().max(at.y.abs()) < 4.0 * self.front {
            return from;
        }
        let comes_near = |x: f64, slope: f64| way * (-x - way * self.front.copysign(slope)) / slope;
        let ahead = [comes_near(ray.x, ray.u), comes_near(ray.y, ray.v)];
        // Along an axis a ray does not come nearer: NaN, or beyond all numbers.
        let ahead = ahead.into_iter().filter(|t| t.is_finite());
        way * ahead.fold(way * from, f64::max)
    }

    /// Whether light on a ray meets a target between `from` and `distance`; at that very distance when `inclusive`.
    /// Looked for backwards, from there; what `ignored` says does not count.
    pub(crate) fn blocks(
        &self,
        ray: &TwoPlane,
        from: f64,
        distance: f64,
        inclusive: bool,
        ignored: impl Fn(&T) -> bool,
    ) -> bool {
        let end = ray.travelled(distance);
        let origin = Vec3A::new(single(end.x), single(end.y), single(distance));
        let direction = Vec3A::new(single(-ray.u), single(-ray.v), -1.0);
        let mut blocked = false;
        self.bvh.ray_traverse(
            Ray::new(origin, direction, 0.0, self.far),
            &mut RayHit::none(),
            |_, i| {
                let Target { form, tag } = &self.targets[i];
                let before = |at: f64| at > from && (at < distance || inclusive && at <= distance);
                if form.meets(ray, from).is_some_and(before) && !ignored(tag) {
                    blocked = true;
                    // Nothing beyond matters any more.
                    return 0.0;
                }
                f32::INFINITY
            },
        );
        blocked
    }
}

fn extent<T>(target: &Target<T>) -> f64 {
    let [low, high] = target.form.bounds();
    low.abs().max(high.abs()).max_element()
}

/// The box around a target, which are all within `extent`.
fn padded<T>(target: &Target<T>, extent: f64) -> Aabb {
    let [low, high] = target.form.bounds();
    let by = PADDING * extent;
    let (low, high) = (low - by, high + by);
    let corner = |p: DVec3| Vec3A::new(single(p.x), single(p.y), single(p.z));
    if [low, high]
        .iter()
        .all(|p| p.is_finite() && p.abs().max_element() <= 2.0 * LARGEST)
    {
        Aabb::new(corner(low), corner(high))
    } else {
        let everywhere = DVec3::splat(extent + by);
        Aabb::new(corner(-everywhere), corner(everywhere))
    }
}

#[inline]
#[expect(
    clippy::cast_possible_truncation,
    reason = "f32 only names candidates; padding covers its rounding"
)]
fn single(x: f64) -> f32 {
    x as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_field::random::{self, Stream};
    use etendue_field::{Disc, Rectangle};

    /// Squares that share edges, discs and triangles: the cases in which rounding would leak.
    fn targets() -> Vec<Target<u32>> {
        let mut targets = Vec::new();
        for layer in 1..4u32 {
            for i in 0..20u32 {
                for j in (layer % 2..20).step_by(2) {
                    let center = [0.1 * f64::from(i) - 1.0, 0.1 * f64::from(j) - 1.0];
                    let shape = if layer == 2 {
                        let radius = 0.05;
                        Shape::Disc(Disc { center, radius })
                    } else {
                        let size = [0.1, 0.1];
                        Shape::Rectangle(Rectangle { center, size })
                    };
                    let distance = f64::from(layer);
                    targets.push(Form::Flat { distance, shape });
                }
            }
        }
        let corner = |i: u32| {
            let t = 0.7 * f64::from(i);
            DVec3::new(t.sin(), (1.3 * t).cos(), 1.5 + 0.4 * (2.9 * t).sin())
        };
        targets.extend((0..60).map(|i| Form::Triangle([corner(i), corner(i + 1), corner(i + 2)])));
        targets.extend((0..40).map(|i| {
            let d = corner(i) - DVec3::new(0.0, 0.0, 1.0);
            let center = [0.02, -0.01];
            let shape = Shape::Disc(Disc {
                center,
                radius: 0.1,
            });
            let frame = Frame::new(corner(i + 3), d, DVec3::X).unwrap_or(Frame::IDENTITY);
            let frame = Box::new(frame);
            Form::Oblique { frame, shape }
        }));
        let tags = 0u32..;
        let tagged = targets.into_iter().zip(tags);
        tagged.map(|(form, tag)| Target { form, tag }).collect()
    }

    fn scaled(form: &Form, scale: f64) -> Form {
        match form {
            Form::Flat { distance, shape } => Form::Flat {
                distance: distance * scale,
                shape: match shape {
                    Shape::Rectangle(r) => Shape::Rectangle(Rectangle {
                        center: r.center.map(|c| c * scale),
                        size: r.size.map(|s| s * scale),
                    }),
                    Shape::Disc(d) => Shape::Disc(Disc {
                        center: d.center.map(|c| c * scale),
                        radius: d.radius * scale,
                    }),
                },
            },
            Form::Oblique { frame, shape } => {
                let Form::Flat { shape, .. } = scaled(
                    &Form::Flat {
                        distance: 0.0,
                        shape: *shape,
                    },
                    scale,
                ) else {
                    unreachable!("a flat form scales to a flat form")
                };
                let origin = frame.origin * scale;
                let frame = Frame { origin, ..**frame };
                Form::Oblique {
                    frame: Box::new(frame),
                    shape,
                }
            }
            Form::Triangle(corners) => Form::Triangle(corners.map(|p| p * scale)),
            Form::Shaded { .. } | Form::Smooth(_) => unreachable!("none here"),
        }
    }

    #[test]
    fn agrees_with_every_target_tried_in_turn() {
        for scale in [1e-30, 1e-3, 1.0, 1e3, 1e30] {
            let mut all = targets();
            all.iter_mut().for_each(|t| t.form = scaled(&t.form, scale));
            let found = Targets::new(&all, 0.5 * scale);
            let (mut hits, mut blocked) = (0, 0);
            for index in 0..20_000 {
                let w = random::words(3, Stream::Photon, index, 0).map(|w| random::unit(w) - 0.5);
                let ray = TwoPlane {
                    x: w[0] * scale,
                    y: w[1] * scale,
                    u: w[2],
                    v: w[3],
                };
                let met = all.iter().filter_map(|t| t.form.meets(&ray, 0.0));
                let expected = met.fold(f64::INFINITY, f64::min);
                let first = found.first(&ray, 0.0).map_or(f64::INFINITY, |(at, _)| at);
                assert!(
                    first.total_cmp(&expected).is_eq(),
                    "{ray:?} at scale {scale}"
                );
                hits += u32::from(first.is_finite());
                let met = all.iter().filter_map(|t| t.form.meets(&ray, 0.0));
                let farthest = met.fold(f64::NEG_INFINITY, f64::max);
                let last = found.last(&ray).map_or(f64::NEG_INFINITY, |(at, _)| at);
                assert!(last.total_cmp(&farthest).is_eq(), "{ray:?}: last");
                for (distance, inclusive) in [(1.0, false), (1.0, true), (1.6, true), (2.0, false)]
                {
                    let distance = distance * scale;
                    let expected = expected < distance || inclusive && expected <= distance;
                    let blocks = found.blocks(&ray, 0.0, distance, inclusive, |_| false);
                    assert_eq!(blocks, expected, "{ray:?} to {distance}");
                    blocked += u32::from(blocks);
                }
            }
            assert!(hits > 10_000, "{hits} rays hit: too few to tell");
            assert!((10_000..70_000).contains(&blocked), "{blocked} of 80,000");
        }
    }

    /// What no legal scene has: the builder is spared it, and what is sound beside it is found.
    #[test]
    fn forms_without_a_box_are_candidates_everywhere() {
        for bad in [f64::NAN, f64::INFINITY, 1e300] {
            let mut all = targets();
            let strange = Form::Triangle([DVec3::splat(bad); 3]);
            all.extend((0..50).map(|tag| Target {
                form: strange.clone(),
                tag,
            }));
            let found = Targets::new(&all, 0.5);
            let straight = TwoPlane::default();
            assert!(found.first(&straight, 0.0).is_some(), "{bad}");
        }
    }

    /// Rays at the common edges and corners of a closed sheet of triangles: none passes.
    #[test]
    fn triangles_that_share_edges_leak_nothing() {
        const N: u32 = 16;
        let corner = |i: u32, j: u32| {
            let [x, y] = [i, j].map(|k| f64::from(k) / f64::from(N) * 2.0 - 1.0);
            DVec3::new(x, y, 1.0 + 0.1 * (7.0 * x).sin() * (5.0 * y).cos())
        };
        let mut sheet = Vec::new();
        for i in 0..N {
            for j in 0..N {
                let [a, b, c, d] =
                    [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| corner(i, j));
                sheet.extend([[a, b, c], [a, c, d]].map(|corners| Target {
                    form: Form::Triangle(corners),
                    tag: (),
                }));
            }
        }
        let found = Targets::new(&sheet, 0.5);
        for i in 1..N {
            for j in 1..N {
                for t in [0.0, 0.3, 0.5] {
                    // A point of an edge, seen from a point of the light.
                    let p = corner(i, j).lerp(corner(i - 1, j - 1), t);
                    let (x, y) = (0.013 * f64::from(i), -0.017 * f64::from(j));
                    let [u, v] = [(p.x - x) / p.z, (p.y - y) / p.z];
                    let ray = TwoPlane { x, y, u, v };
                    assert!(found.first(&ray, 0.0).is_some(), "{ray:?}");
                }
            }
        }
    }
}
