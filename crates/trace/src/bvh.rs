//! The only file that knows obvhs and f32.
//!
//! The hierarchy, in f32, only names candidates; whether and where a rectangle is hit is decided in f64.
//! Boxes are padded by more than f32 rounding, so no candidate is missed.

use etendue_field::{Rectangle, TwoPlane};
use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::ray::{Ray, RayHit};
use std::time::Duration;

/// A rectangle across the central ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Target<T> {
    pub(crate) distance: f64,
    pub(crate) rectangle: Rectangle,
    /// What it is.
    pub(crate) tag: T,
}

/// Rectangles across the central ray, and the hierarchy that finds the first one hit.
pub(crate) struct Targets<T> {
    bvh: Bvh2,
    /// In the order of the hierarchy's leaves.
    targets: Vec<Target<T>>,
    /// Beyond everything.
    far: f32,
}

/// Boxes grow by this share of the scene's extent: f32 rounding is 6e-8 of it, a ray adds a few of those.
const PADDING: f64 = 1e-5;

impl<T: Copy> Targets<T> {
    /// `origins` is the largest coordinate a ray starts from.
    pub(crate) fn new(targets: &[Target<T>], origins: f64) -> Self {
        let extent = targets.iter().map(extent).fold(origins, f64::max);
        let boxes: Vec<Aabb> = targets
            .iter()
            .map(|t| padded(t, PADDING * extent))
            .collect();
        // Without pre-splits: they are for triangles.
        let parameters = BvhBuildParams {
            pre_split: false,
            ..BvhBuildParams::very_slow_build()
        };
        let bvh = build_bvh2(&boxes, parameters, &mut Duration::default());
        let targets = bvh
            .primitive_indices
            .iter()
            .map(|i| targets[*i as usize])
            .collect();
        Self {
            bvh,
            targets,
            far: single(4.0 * extent),
        }
    }

    /// The first target hit by a ray that leaves the light's plane.
    #[inline]
    pub(crate) fn first(&self, ray: &TwoPlane) -> Option<&Target<T>> {
        let origin = Vec3A::new(single(ray.x), single(ray.y), 0.0);
        let direction = Vec3A::new(single(ray.u), single(ray.v), 1.0);
        let mut first: Option<&Target<T>> = None;
        let mut nearest = f64::INFINITY;
        self.bvh.ray_traverse(
            Ray::new(origin, direction, 0.0, self.far),
            &mut RayHit::none(),
            |_, i| {
                let target = &self.targets[i];
                let at = ray.travelled(target.distance);
                if target.distance < nearest && target.rectangle.contains(at.x, at.y) {
                    nearest = target.distance;
                    first = Some(target);
                    // Boxes this far are still opened: the first hit is decided in f64.
                    return single(target.distance * (1.0 + PADDING));
                }
                f32::INFINITY
            },
        );
        first
    }
}

fn extent<T>(target: &Target<T>) -> f64 {
    target.rectangle.reach().max(target.distance.abs())
}

fn padded<T>(target: &Target<T>, by: f64) -> Aabb {
    let [x, y] = [0, 1].map(|axis| target.rectangle.extent(axis));
    let corner = |i: usize, by: f64| {
        Vec3A::new(
            single(x[i] + by),
            single(y[i] + by),
            single(target.distance + by),
        )
    };
    Aabb::new(corner(0, -by), corner(1, by))
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

    /// Squares that share edges and a wall behind them: the case in which rounding would leak.
    #[test]
    fn agrees_with_every_target_tried_in_turn() {
        let mut targets = Vec::new();
        for layer in 1..4u32 {
            for i in 0..20u32 {
                for j in (layer % 2..20).step_by(2) {
                    targets.push(Target {
                        distance: f64::from(layer),
                        rectangle: Rectangle {
                            center: [0.1 * f64::from(i) - 1.0, 0.1 * f64::from(j) - 1.0],
                            size: [0.1, 0.1],
                        },
                        tag: (layer, i, j),
                    });
                }
            }
        }
        for scale in [1e-3, 1.0, 1e3] {
            let scaled: Vec<_> = targets
                .iter()
                .map(|t| Target {
                    distance: t.distance * scale,
                    rectangle: Rectangle {
                        center: t.rectangle.center.map(|c| c * scale),
                        size: t.rectangle.size.map(|s| s * scale),
                    },
                    tag: t.tag,
                })
                .collect();
            let found = Targets::new(&scaled, 0.5 * scale);
            let mut hits = 0;
            for index in 0..20_000 {
                let w = random::words(3, Stream::Photon, index, 0).map(|w| random::unit(w) - 0.5);
                let ray = TwoPlane {
                    x: w[0] * scale,
                    y: w[1] * scale,
                    u: w[2],
                    v: w[3],
                };
                let expected = scaled
                    .iter()
                    .filter(|t| {
                        let at = ray.travelled(t.distance);
                        t.rectangle.contains(at.x, at.y)
                    })
                    .map(|t| t.distance)
                    .fold(f64::INFINITY, f64::min);
                let first = found.first(&ray).map_or(f64::INFINITY, |t| t.distance);
                assert!(
                    first.total_cmp(&expected).is_eq(),
                    "{ray:?} at scale {scale}"
                );
                hits += u32::from(first.is_finite());
            }
            assert!(hits > 10_000, "{hits} rays hit: too few to tell");
        }
    }
}
