//! Finds what rays hit among all surfaces of a world.

use super::form::Form;
use super::lanes::{PieceGroups, PieceShape};
use super::placed::Placed;
use super::ray::{Ray, Spot, around};
use super::tree::{PieceName, PieceTree, WHOLE};
use etendue_bvh::WidePrimitive;
use glam::DVec3;
use std::sync::Arc;

/// A structure that finds hits.
#[derive(Debug)]
pub(super) enum SurfaceSearch {
    /// For small worlds.
    Groups(PieceGroups),
    /// For other worlds.
    Tree(PieceTree),
}

/// The largest number of pieces that are all tested. For more pieces, a tree is faster.
pub(super) const MAX_GROUPED: usize = 64;

/// Size of the triangles below which a mesh has a tree of its own, relative to the size of the
/// world. The boxes in the tree of the world are padded by about a tenth of this.
const FINE: f64 = 1e-4;

impl SurfaceSearch {
    /// Prepares the search for surfaces with their bounds. `origins` is the largest coordinate of
    /// the starting points of rays. Pieces are grouped unless there are more than `max_grouped`.
    pub(super) fn new(
        placed: &[Placed],
        bounds: &[[DVec3; 2]],
        origins: f64,
        max_grouped: usize,
    ) -> Self {
        let names = names(placed, bounds);
        let corners = |name: PieceName| match &placed[name.surface as usize] {
            Placed {
                form: Form::Mesh(mesh),
                to_world,
                ..
            } if name.triangle != WHOLE => {
                let corners = mesh.corners(name.triangle);
                Some(corners.map(|corner| to_world.transform_point3(corner)))
            }
            _ => None,
        };
        if names.len() <= max_grouped {
            let shape = |name: &PieceName| {
                let placed = &placed[name.surface as usize];
                let whole = PieceShape::Whole(&placed.form, &placed.to_local);
                (*name, corners(*name).map_or(whole, PieceShape::Triangle))
            };
            if let Some(groups) = PieceGroups::new(names.iter().map(shape)) {
                return Self::Groups(groups);
            }
        }
        Self::Tree(PieceTree::new(&names, origins, |name| {
            let whole = WidePrimitive::Box(bounds[name.surface as usize]);
            corners(name).map_or(whole, WidePrimitive::Triangle)
        }))
    }

    /// The first hit of a ray at a distance strictly within bounds, and the index of the
    /// surface.
    #[inline]
    pub(super) fn first(
        &self,
        placed: &[Placed],
        ray: &Ray,
        within: [f64; 2],
    ) -> Option<(usize, Spot)> {
        match self {
            Self::Groups(groups) => groups.first(ray, within),
            Self::Tree(tree) => {
                let whole = |shape: usize, within| placed[shape].first(ray, within);
                tree.first(ray, within, |_| true, whole)
            }
        }
    }

    /// The first hit of a ray with the triangles of one surface.
    pub(super) fn first_of(&self, surface: usize, ray: &Ray, within: [f64; 2]) -> Option<Spot> {
        match self {
            Self::Groups(groups) => groups.first_of(surface, ray, within),
            Self::Tree(tree) => {
                let counts = |other| other == surface;
                Some(tree.first(ray, within, counts, |_, _| None)?.1)
            }
        }
    }

    /// Checks whether a ray hits anything at a distance strictly within bounds.
    #[inline]
    pub(super) fn is_occluded(&self, placed: &[Placed], ray: &Ray, within: [f64; 2]) -> bool {
        match self {
            Self::Groups(groups) => groups.is_occluded(ray, within),
            Self::Tree(tree) => {
                tree.is_occluded(ray, within, |shape| placed[shape].is_occluded(ray, within))
            }
        }
    }
}

/// The pieces of surfaces: the triangles of meshes, and other surfaces. A mesh of several
/// surfaces, or with small triangles, gets its own tree and is one piece.
fn names(placed: &[Placed], bounds: &[[DVec3; 2]]) -> Vec<PieceName> {
    let size = |[low, high]: [DVec3; 2]| (high - low).length();
    let smallest = FINE * size(around(bounds.iter().copied()));
    let mut names = Vec::new();
    for ((surface, placed), bounds) in (0..).zip(placed).zip(bounds) {
        if let Form::Mesh(mesh) = &placed.form {
            let is_fine = mesh.fineness() * size(*bounds) < smallest;
            if !is_fine && Arc::strong_count(mesh) == 1 {
                names.extend(mesh.names(surface));
                continue;
            }
            mesh.build_tree();
        }
        names.push(PieceName {
            surface,
            triangle: WHOLE,
        });
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::placed::placed;
    use etendue_transform::random::{self, Stream};
    use etendue_world::{Geometry, Shape, Triangles};
    use glam::DAffine3;

    /// Three numbers from −1 to 1.
    fn numbers(index: u64, block: u32) -> DVec3 {
        let [x, y, z, _] = random::words(1, Stream::Points, index, block).map(random::unit);
        2.0 * DVec3::new(x, y, z) - 1.0
    }

    /// Returns placed shapes of every kind; the mesh has three triangles.
    fn shapes() -> Vec<Placed> {
        let corners = (0..9).map(|i| numbers(100, i)).collect();
        let corners = Triangles::new(corners, vec![[0, 1, 2], [3, 4, 5], [6, 7, 8]], None, None);
        let geometries = [
            Geometry::Rectangle,
            Geometry::Disc,
            Geometry::Sphere,
            Geometry::Cylinder,
            Geometry::Mesh(Arc::new(corners.unwrap())),
        ];
        let shapes = (0..10).map(|i| {
            let [x, y, z] = [0, 1, 2].map(|block| numbers(i, block));
            let geometry = geometries[usize::try_from(i).unwrap() % 5].clone();
            let turned = glam::DMat3::from_cols(x, y, z);
            let to_world = DAffine3::from_mat3_translation(turned, 3.0 * numbers(i, 3));
            Shape::new(geometry, to_world, 0)
        });
        // Meshes of one shape are not shared, so that their triangles are pieces.
        shapes.flat_map(|shape| placed(&[shape])).collect()
    }

    /// Groups of pieces and a tree find the same hits.
    #[test]
    fn small_and_large_worlds_are_searched_alike() {
        let placed = shapes();
        let bounds: Vec<_> = placed.iter().map(Placed::bounds).collect();
        let (small, large) = [64, 0]
            .map(|most| SurfaceSearch::new(&placed, &bounds, 9.0, most))
            .into();
        assert!(
            matches!(small, SurfaceSearch::Groups(_)) && matches!(large, SurfaceSearch::Tree(_))
        );
        let mut met = 0;
        for index in 1000..20_000 {
            let from = 4.0 * numbers(index, 0);
            let along = (numbers(index, 1) * 3.0 - from).normalize();
            let ray = Ray { from, along };
            let within = [0.0, 2.0 + 4.0 * numbers(index, 2).x.abs()];
            let found = [&small, &large].map(|search| search.first(&placed, &ray, within));
            let [a, b] = found.map(|found| found.map(|(shape, spot)| (shape, spot.triangle)));
            // The number of a triangle has no meaning for other shapes.
            let of_mesh = a.is_some_and(|(shape, _)| shape % 5 == 4);
            assert_eq!(
                a.map(|(shape, _)| shape),
                b.map(|(shape, _)| shape),
                "{index}"
            );
            assert!(!of_mesh || a == b, "{index}");
            if let [Some((_, a)), Some((_, b))] = found {
                assert!(
                    (a.distance - b.distance).abs() < 1e-9 * a.distance,
                    "{index}"
                );
                assert!((a.weights - b.weights).length() < 1e-12, "{index}");
                met += 1;
            }
            for search in [&small, &large] {
                assert_eq!(
                    search.is_occluded(&placed, &ray, within),
                    a.is_some(),
                    "{index}"
                );
            }
            for shape in [4, 9] {
                let spots = [&small, &large].map(|search| search.first_of(shape, &ray, within));
                let [a, b] =
                    spots.map(|spot| spot.map(|spot| (spot.triangle, spot.distance.to_bits())));
                assert_eq!(a, b, "{index}");
            }
        }
        assert!(met > 1000, "{met}: too few to tell");
    }
}
