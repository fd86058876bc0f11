//! Triangle meshes prepared for ray intersection.

use super::local::Local;
use super::triangle::TriangleRay;
use etendue_bvh::WideHierarchy;
use etendue_sampling::triangle;
use etendue_world::{TexturePoint, Triangles};
use glam::{DAffine3, DVec2, DVec3};
use std::sync::Arc;

/// Triangles with a bounding volume hierarchy.
#[derive(Debug)]
pub(crate) struct WorldMesh {
    triangles: Arc<Triangles>,
    hierarchy: WideHierarchy,
    /// The vertices of triangles, in the order of the hierarchy.
    ordered: Vec<[u32; 3]>,
    bounds: [DVec3; 2],
}

impl WorldMesh {
    pub(super) fn new(triangles: Arc<Triangles>) -> Self {
        let corners = triangles.corners();
        let bounds = |i: usize| {
            let [a, b, c] = places(&triangles, corners[i]);
            [a.min(b).min(c), a.max(b).max(c)]
        };
        let all = (0..corners.len())
            .map(bounds)
            .reduce(|[a, b], [low, high]| [a.min(low), b.max(high)]);
        let all = all.unwrap_or_default();
        // Rays may begin far from the mesh, so the boxes are padded for rounding errors at this
        // distance.
        let origins = 10.0 * (all[1] - all[0]).length();
        let hierarchy = WideHierarchy::over_triangles(corners.len(), origins, |i| {
            places(&triangles, corners[i])
        });
        let order = hierarchy.order().iter();
        Self {
            ordered: order.map(|i| corners[*i as usize]).collect(),
            hierarchy,
            bounds: all,
            triangles,
        }
    }

    pub(super) fn bounds(&self) -> [DVec3; 2] {
        self.bounds
    }

    pub(super) fn first(
        &self,
        start: DVec3,
        along: DVec3,
        [from, until]: [f64; 2],
    ) -> Option<(f64, Local)> {
        let sight = TriangleRay::new(start, along);
        let mut first: Option<(f64, usize, DVec2)> = None;
        let mut end = until;
        self.hierarchy.along(start, along, [from, until], |i| {
            if let Some((at, place)) = sight.meets(places(&self.triangles, self.ordered[i]))
                && at > from
                // Among hits at the same distance, the hit with the lowest index is used, so the
                // result does not depend on the traversal order.
                && (at < end || first.is_some_and(|(first, j, _)| (at, i) < (first, j)))
            {
                first = Some((at, i, place));
                end = at;
            }
            end
        });
        first.map(|(at, i, place)| (at, self.local(self.hierarchy.order()[i] as usize, place)))
    }

    /// Checks whether a ray hits the mesh at a distance strictly within bounds.
    pub(super) fn is_met(&self, start: DVec3, along: DVec3, [from, until]: [f64; 2]) -> bool {
        let sight = TriangleRay::new(start, along);
        let mut is_met = false;
        self.hierarchy.along(start, along, [from, until], |i| {
            let corners = places(&self.triangles, self.ordered[i]);
            is_met |= sight
                .meets(corners)
                .is_some_and(|(at, _)| at > from && at < until);
            // After a hit, the traversal ends.
            if is_met { f64::NEG_INFINITY } else { until }
        });
        is_met
    }

    /// Returns the point of a triangle, given by its index in the mesh, whose barycentric
    /// coordinates are `place`. The coordinates belong to the second and the third corner.
    fn local(&self, number: usize, place: DVec2) -> Local {
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
            shading: shading.unwrap_or(normal),
            point: TexturePoint {
                uv,
                triangle: number,
                weights: place,
            },
            along_u,
        }
    }

    /// Returns the area of each triangle in the world.
    pub(super) fn areas(&self, to_world: &DAffine3) -> impl Iterator<Item = f64> {
        self.triangles.corners().iter().map(|corners| {
            let [a, b, c] = places(&self.triangles, *corners);
            let [x, y] = [b - a, c - a].map(|side| to_world.transform_vector3(side));
            0.5 * x.cross(y).length()
        })
    }

    /// Returns a point sampled uniformly on a triangle.
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

fn places(triangles: &Triangles, corners: [u32; 3]) -> [DVec3; 3] {
    corners.map(|corner| triangles.vertices()[corner as usize])
}
