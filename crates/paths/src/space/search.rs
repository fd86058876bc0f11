//! Finds what rays hit among all surfaces of a world.

use super::form::Form;
use super::lanes::{PieceGroups, PieceShape};
use super::local::Spot;
use super::tree::{PieceName, Tree, WHOLE};
use super::{Placed, Ray};
use etendue_bvh::Primitive;
use glam::DVec3;
use std::sync::Arc;

/// A structure that finds hits.
#[derive(Debug)]
pub(super) enum Search {
    /// For small worlds.
    Groups(PieceGroups),
    /// For other worlds.
    Tree(Tree),
}

/// The largest number of pieces that are all tested. For more pieces, a tree is faster.
const MAX_GROUPED: usize = 64;

/// Size of the triangles below which a mesh has a tree of its own, relative to the size of the
/// world. The boxes in the tree of the world are padded by about a tenth of this.
const FINE: f64 = 1e-4;

impl Search {
    /// Prepares the search for surfaces with their bounds. `origins` is the largest coordinate of
    /// the starting points of rays.
    pub(super) fn new(placed: &[Placed], bounds: &[[DVec3; 2]], origins: f64) -> Self {
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
        if names.len() <= MAX_GROUPED {
            let shape = |name: &PieceName| {
                let placed = &placed[name.surface as usize];
                let whole = PieceShape::Whole(&placed.form, &placed.to_local);
                (*name, corners(*name).map_or(whole, PieceShape::Triangle))
            };
            if let Some(groups) = PieceGroups::new(names.iter().map(shape)) {
                return Self::Groups(groups);
            }
        }
        Self::Tree(Tree::new(&names, origins, |name| {
            let whole = Primitive::Box(bounds[name.surface as usize]);
            corners(name).map_or(whole, Primitive::Triangle)
        }))
    }

    /// Returns the first hit of a ray at a distance strictly within bounds, and the index of the
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

    /// Returns the first hit of a ray with the triangles of one surface.
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
    pub(super) fn is_met(&self, placed: &[Placed], ray: &Ray, within: [f64; 2]) -> bool {
        match self {
            Self::Groups(groups) => groups.is_met(ray, within),
            Self::Tree(tree) => tree.is_met(ray, within, |shape| placed[shape].is_met(ray, within)),
        }
    }
}

/// Returns the pieces of surfaces: the triangles of meshes, and other surfaces. A mesh of several
/// surfaces, or with small triangles, gets its own tree and is one piece.
fn names(placed: &[Placed], bounds: &[[DVec3; 2]]) -> Vec<PieceName> {
    let size = |[low, high]: [DVec3; 2]| (high - low).length();
    let world = bounds.iter().copied();
    let world = world.reduce(|[a, b], [low, high]| [a.min(low), b.max(high)]);
    let smallest = FINE * world.map_or(0.0, size);
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
