//! A hierarchy over the triangles of meshes and over other surfaces.

use super::ray::{Ray, Spot};
use super::triangle::TriangleRay;
use etendue_bvh::{WideHierarchy, WidePrimitive};
use glam::DVec3;

/// The pieces of surfaces, with a bounding volume hierarchy.
#[derive(Debug)]
pub(super) struct PieceTree {
    hierarchy: WideHierarchy,
    /// The pieces, in the order of the hierarchy.
    pieces: Vec<TreePiece>,
}

/// A triangle of a mesh, or a whole surface.
#[derive(Clone, Copy, Debug)]
struct TreePiece {
    /// The corners of the triangle; NaN for a whole surface, which no triangle test hits.
    corners: [DVec3; 3],
    name: PieceName,
}

/// The index of a surface, and the number of a triangle in its mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct PieceName {
    pub(super) surface: u32,
    /// [`WHOLE`] for a whole surface.
    pub(super) triangle: u32,
}

/// Stands for all of a surface instead of a triangle.
pub(super) const WHOLE: u32 = u32::MAX;

impl PieceTree {
    /// Builds the tree of pieces. `origins` is the largest coordinate of the starting points of
    /// rays.
    pub(super) fn new(
        names: &[PieceName],
        origins: f64,
        primitive: impl Fn(PieceName) -> WidePrimitive + Sync,
    ) -> Self {
        let hierarchy = WideHierarchy::new(names.len(), origins, |i| primitive(names[i]));
        let piece = |i: &u32| {
            let name = names[*i as usize];
            let corners = match primitive(name) {
                WidePrimitive::Triangle(corners) => corners,
                WidePrimitive::Box(_) => [DVec3::NAN; 3],
            };
            TreePiece { corners, name }
        };
        Self {
            pieces: hierarchy.order().iter().map(piece).collect(),
            hierarchy,
        }
    }

    /// The first hit of a ray with a surface that `counts`, at a distance strictly within
    /// bounds, and the index of the surface. The direction of the ray has a length of at least 1.
    /// `whole` intersects a whole surface.
    #[inline]
    pub(super) fn first(
        &self,
        ray: &Ray,
        [from, until]: [f64; 2],
        counts: impl Fn(usize) -> bool,
        whole: impl Fn(usize, [f64; 2]) -> Option<Spot>,
    ) -> Option<(usize, Spot)> {
        let sight = TriangleRay::new(ray.from, ray.along);
        let mut first: Option<(usize, Spot)> = None;
        let (mut end, mut nearest) = (until, 0);
        self.hierarchy
            .along(ray.from, ray.along, [from, until], |i| {
                let TreePiece { corners, name } = &self.pieces[i];
                let surface = name.surface as usize;
                let spot = match name.triangle {
                    _ if !counts(surface) => None,
                    WHOLE => whole(surface, [from, end]),
                    triangle => sight
                        .meets(corners)
                        .map(|(distance, weights)| Spot {
                            distance,
                            triangle,
                            weights,
                        })
                        // Among hits at the same distance, the piece with the lowest number is
                        // used, so the result does not depend on the traversal order.
                        .filter(|at| at.distance > from && (at.distance, i) < (end, nearest)),
                };
                if let Some(spot) = spot {
                    (end, nearest) = (spot.distance, i);
                    first = Some((surface, spot));
                }
                end
            });
        first
    }

    /// Checks whether a ray hits anything at a distance strictly within bounds. The direction of
    /// the ray has a length of at least 1. `whole` tests a whole surface.
    #[inline]
    pub(super) fn is_occluded(
        &self,
        ray: &Ray,
        within: [f64; 2],
        whole: impl Fn(usize) -> bool,
    ) -> bool {
        let [from, until] = within;
        let sight = TriangleRay::new(ray.from, ray.along);
        let mut is_met = false;
        self.hierarchy.along(ray.from, ray.along, within, |i| {
            let TreePiece { corners, name } = &self.pieces[i];
            is_met |= match name.triangle {
                WHOLE => whole(name.surface as usize),
                _ => sight
                    .meets(corners)
                    .is_some_and(|(at, _)| at > from && at < until),
            };
            // After a hit, the traversal ends.
            if is_met { f64::NEG_INFINITY } else { until }
        });
        is_met
    }
}
