use super::form::Local;
use etendue_scene::Hierarchy;
use etendue_world::Triangles;
use glam::{DAffine3, DVec2, DVec3};
use std::sync::Arc;

/// Triangles with a hierarchy over them.
#[derive(Debug)]
pub(crate) struct Mesh {
    triangles: Arc<Triangles>,
    hierarchy: Hierarchy,
    bounds: [DVec3; 2],
}

impl Mesh {
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
        // Rays begin some way from it: padding counts that in.
        let origins = 10.0 * (all[1] - all[0]).length();
        let hierarchy = Hierarchy::new(corners.len(), origins, bounds);
        Self {
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
        let mut first: Option<(f64, usize, DVec2)> = None;
        self.hierarchy.along(start, along, [from, until], |i| {
            let triangle = self.hierarchy.order()[i] as usize;
            if let Some((at, place)) = met(
                places(&self.triangles, self.triangles.corners()[triangle]),
                start,
                along,
            ) && at > from
                && at < first.map_or(until, |(at, ..)| at)
            {
                first = Some((at, triangle, place));
            }
            first.map_or(until, |(at, ..)| at)
        });
        first.map(|(at, triangle, place)| (at, self.local(triangle, place)))
    }

    /// At barycentric coordinates of the second and the third corner.
    fn local(&self, triangle: usize, place: DVec2) -> Local {
        let corners = self.triangles.corners()[triangle];
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
            uv,
            along_u,
        }
    }

    /// The area of each triangle once placed.
    pub(super) fn areas(&self, to_world: &DAffine3) -> impl Iterator<Item = f64> {
        self.triangles.corners().iter().map(|corners| {
            let [a, b, c] = places(&self.triangles, *corners);
            let [x, y] = [b - a, c - a].map(|side| to_world.transform_vector3(side));
            0.5 * x.cross(y).length()
        })
    }

    /// A place drawn evenly over a triangle.
    pub(super) fn sample(&self, triangle: usize, [a, b]: [f64; 2]) -> (DVec3, Local) {
        let root = a.sqrt();
        let place = DVec2::new(root * (1.0 - b), root * b);
        let [p, q, r] = places(&self.triangles, self.triangles.corners()[triangle]);
        (
            p + place.x * (q - p) + place.y * (r - p),
            self.local(triangle, place),
        )
    }
}

fn places(triangles: &Triangles, corners: [u32; 3]) -> [DVec3; 3] {
    corners.map(|corner| triangles.vertices()[corner as usize])
}

/// Where a ray meets a triangle, with barycentric coordinates (Möller and Trumbore 1997, *Fast, minimum storage ray-triangle intersection*).
fn met([a, b, c]: [DVec3; 3], start: DVec3, along: DVec3) -> Option<(f64, DVec2)> {
    let (ab, ac) = (b - a, c - a);
    let across = along.cross(ac);
    let volume = ab.dot(across);
    let from = (start - a) / volume;
    let u = from.dot(across);
    let turned = from.cross(ab);
    let v = along.dot(turned);
    // In a triangle without area, or along its plane, these are no numbers.
    let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
    inside.then(|| (ac.dot(turned), DVec2::new(u, v)))
}
