//! Triangle meshes prepared for ray intersection.

use super::ray::{Local, Ray, Spot, around};
use super::tree::{PieceName, PieceTree};
use etendue_bvh::WidePrimitive;
use etendue_sampling::triangle;
use etendue_world::{TexturePoint, Triangles};
use glam::{DAffine3, DVec2, DVec3};
use std::sync::{Arc, OnceLock};

/// A mesh, with a hierarchy of its own if it is intersected in local coordinates.
#[derive(Debug)]
pub(crate) struct WorldMesh {
    triangles: Arc<Triangles>,
    /// The lowest and the highest corner of the bounding box.
    pub(super) bounds: [DVec3; 2],
    tree: OnceLock<PieceTree>,
}

impl WorldMesh {
    pub(super) fn new(triangles: Arc<Triangles>) -> Self {
        let corners = triangles.corners().iter().copied();
        let bounds = |corners: [u32; 3]| {
            let [a, b, c] = places(&triangles, corners);
            [a.min(b).min(c), a.max(b).max(c)]
        };
        Self {
            bounds: around(corners.map(bounds)),
            triangles,
            tree: OnceLock::new(),
        }
    }

    /// Builds the tree, after which rays are intersected in local coordinates.
    pub(super) fn build_tree(&self) {
        self.tree.get_or_init(|| {
            // Rays may begin far from the mesh, so the boxes are padded for rounding errors at
            // this distance.
            let origins = 10.0 * (self.bounds[1] - self.bounds[0]).length();
            let names: Vec<PieceName> = self.names(0).collect();
            PieceTree::new(&names, origins, |name| {
                WidePrimitive::Triangle(self.corners(name.triangle))
            })
        });
    }

    /// The approximate size of the triangles, relative to the size of the mesh.
    pub(super) fn fineness(&self) -> f64 {
        (self.triangles.corners().len() as f64).sqrt().recip()
    }

    /// Whether the mesh has a tree of its own.
    pub(super) fn has_tree(&self) -> bool {
        self.tree.get().is_some()
    }

    /// The triangles as pieces of a surface.
    pub(super) fn names(&self, surface: u32) -> impl Iterator<Item = PieceName> + use<> {
        let numbers = (0..).take(self.triangles.corners().len());
        numbers.map(move |triangle| PieceName { surface, triangle })
    }

    /// The corners of a triangle.
    pub(super) fn corners(&self, triangle: u32) -> [DVec3; 3] {
        places(&self.triangles, self.triangles.corners()[triangle as usize])
    }

    pub(super) fn first(&self, ray: &Ray, within: [f64; 2]) -> Option<Spot> {
        let (ray, scale) = scaled(ray);
        let within = within.map(|at| at * scale);
        let (_, spot) = self
            .tree
            .get()?
            .first(&ray, within, |_| true, |_, _| None)?;
        Some(Spot {
            distance: spot.distance / scale,
            ..spot
        })
    }

    /// Checks whether a ray hits the mesh at a distance strictly within bounds.
    pub(super) fn is_occluded(&self, ray: &Ray, within: [f64; 2]) -> bool {
        let (ray, scale) = scaled(ray);
        let within = within.map(|at| at * scale);
        self.tree
            .get()
            .is_some_and(|tree| tree.is_occluded(&ray, within, |_| false))
    }

    /// The point of a triangle, given by its index in the mesh, whose barycentric
    /// coordinates are `place`. The coordinates belong to the second and the third corner.
    #[inline]
    pub(super) fn local(&self, number: usize, place: DVec2) -> Local {
        let corners = self.triangles.corners()[number];
        let [a, b, c] = places(&self.triangles, corners);
        let normal = (b - a).cross(c - a);
        let weights = [1.0 - place.x - place.y, place.x, place.y];
        let shading = self.triangles.normals().map(|normals| {
            let each = corners.iter().zip(weights);
            each.map(|(corner, weight)| weight * normals[*corner as usize].normalize_or_zero())
                .sum()
        });
        let (uv, along_u) = match self.triangles.uvs() {
            None => (place, b - a),
            Some(uvs) => {
                let [p, q, r] = corners.map(|corner| uvs[corner as usize]);
                let (uq, ur) = (q - p, r - p);
                let turned = uq.perp_dot(ur);
                let along_u = ((b - a) * ur.y - (c - a) * uq.y) / turned;
                let uv = weights[0] * p + weights[1] * q + weights[2] * r;
                (uv, if along_u.is_finite() { along_u } else { b - a })
            }
        };
        let shading = shading.filter(|sum: &DVec3| sum.length_squared() > 0.0);
        Local {
            normal,
            shading,
            point: TexturePoint {
                uv,
                triangle: number,
                weights: place,
            },
            along_u,
        }
    }

    /// The area of each triangle in the world.
    pub(super) fn areas(&self, to_world: &DAffine3) -> impl Iterator<Item = f64> {
        self.triangles.corners().iter().map(|corners| {
            let [a, b, c] = places(&self.triangles, *corners);
            let [x, y] = [b - a, c - a].map(|side| to_world.transform_vector3(side));
            0.5 * x.cross(y).length()
        })
    }

    /// A point sampled uniformly on a triangle.
    pub(super) fn sample(&self, number: usize, random: [f64; 2]) -> (DVec3, Local) {
        let place = triangle(random);
        let corners = self.triangles.corners()[number];
        let [p, q, r] = places(&self.triangles, corners);
        (
            p + place.x * (q - p) + place.y * (r - p),
            self.local(number, place),
        )
    }
}

/// A ray with a direction of unit length, and the length of its former direction.
fn scaled(ray: &Ray) -> (Ray, f64) {
    let scale = ray.along.length();
    let along = ray.along / scale;
    (Ray { along, ..*ray }, scale)
}

fn places(triangles: &Triangles, corners: [u32; 3]) -> [DVec3; 3] {
    corners.map(|corner| triangles.vertices()[corner as usize])
}
