//! Rays of a leg, and the occluders beside the path.

use crate::parameter::New;
use etendue_field::{Frame, Patch, enclosing};
use glam::DVec3;
use std::sync::Arc;

/// A straight leg of a ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LegRay {
    /// The point at which the leg starts.
    pub(crate) point: DVec3,
    /// The direction of the leg, a unit vector.
    pub(crate) direction: DVec3,
}

impl LegRay {
    /// The ray with position (x, y) and slopes (u, v) at the light's plane.
    pub(crate) fn new([x, y, u, v]: [f64; 4]) -> Self {
        Self {
            point: DVec3::new(x, y, 0.0),
            direction: DVec3::new(u, v, 1.0).normalize(),
        }
    }

    /// The line through a point along a unit vector. The line starts beyond all its
    /// intersections with a patch.
    pub(crate) fn back(patch: &Patch, through: DVec3, along: DVec3) -> Self {
        let far = 4.0 * patch.aperture + (through - patch.frame.origin).length();
        Self {
            point: through + along * far,
            direction: -along,
        }
    }

    pub(crate) fn at(&self, distance: f64) -> DVec3 {
        self.point + distance * self.direction
    }

    /// The distance below which an intersection is the point where the leg starts.
    pub(crate) fn start(&self) -> f64 {
        ROUNDING * self.point.length()
    }

    /// The distance to the first intersection with a patch, and the patch's unit normal
    /// there, on the side of the patch's D.
    pub(crate) fn met(&self, patch: &Patch) -> Option<(f64, DVec3)> {
        let start = self.start();
        let first = self.hits(patch).filter(|t| *t > start);
        let first = first.min_by(f64::total_cmp)?;
        Some((first, normal(patch, self.at(first))?))
    }

    /// The intersection at which the ray meets a patch from the given side, even if
    /// another intersection is nearer. `side` is 1 for the side of the patch's D and −1 for the
    /// opposite side.
    ///
    /// A ray meets a quadric at most once from either side, so the intersection is unique.
    pub(crate) fn met_from(&self, patch: &Patch, side: f64) -> Option<(f64, DVec3)> {
        let ahead = self.hits(patch).filter(|t| *t > 0.0);
        let mut met = ahead.filter_map(|t| Some((t, normal(patch, self.at(t))?)));
        met.find(|(_, normal)| side * normal.dot(self.direction) < 0.0)
    }

    /// The distances to the intersections of the ray's line with a patch, in any order.
    pub(crate) fn hits(&self, patch: &Patch) -> impl Iterator<Item = f64> + use<> {
        let point = patch.frame.to_local(self.point);
        let direction = patch.frame.vector_to_local(self.direction);
        // Distances are measured from a point near the patch, so that a far start costs no digits.
        let base = if direction.z.abs() > 1e-3 {
            -point.z / direction.z
        } else {
            -point.dot(direction)
        };
        let near = point + direction * base;
        // At distance s from that point, the patch's implicit function is a s² + 2 b s + c.
        let a = (DVec3::from(patch.curvature) * direction).dot(direction);
        let b = patch.gradient(near).dot(direction);
        let c = patch.value(near);
        // To avoid cancellation, the second root is computed as c divided by q, the numerator of
        // the first root.
        let q = -(b + (b * b - a * c).sqrt().copysign(b));
        let patch = *patch;
        let roots = [q / a, c / q].into_iter();
        roots.filter_map(move |s| {
            let is_on_patch = s.is_finite() && patch.contains(near + s * direction);
            is_on_patch.then_some(base + s)
        })
    }
}

/// The unit normal of a patch at one of its points, on the side of the patch's D.
pub(crate) fn normal(patch: &Patch, point: DVec3) -> Option<DVec3> {
    let gradient = patch
        .gradient(patch.frame.to_local(point))
        .try_normalize()?;
    Some(patch.frame.vector_to_world(gradient))
}

/// An occluder, in the frame at the light; it stops every ray that meets it.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// The name of the obstacle, which messages use.
    pub name: String,
    /// The shape of the obstacle and its position.
    pub form: ObstacleForm,
    /// The obstacle stops light only on legs with a smaller index; `None` stands for all legs.
    pub until: Option<usize>,
}

/// The shape and position of an obstacle.
#[derive(Clone, Debug, PartialEq)]
pub enum ObstacleForm {
    /// An opaque rectangle that is centred on the origin of a frame and perpendicular to the
    /// frame's D.
    Rectangle {
        /// The frame of the rectangle.
        frame: Frame,
        /// Size along X and Y, metres.
        size: [f64; 2],
    },
    /// An opaque smooth surface.
    Patch(Patch),
    /// Opaque triangles, which changed copies of a path share.
    Mesh {
        /// The triangles before the shift.
        triangles: Arc<TriangleTree>,
        /// The shift of all triangles.
        shift: DVec3,
    },
}

/// Maximum relative rounding error of a distance.
pub(crate) const ROUNDING: f64 = 1e-9;

impl Obstacle {
    /// Checks whether the obstacle stops a ray within the first `length` metres of the leg with index
    /// `leg`.
    pub(crate) fn stops(&self, leg: usize, ray: &LegRay, length: f64) -> bool {
        if self.until.is_some_and(|until| leg >= until) {
            return false;
        }
        let start = ray.start();
        let is_between = |t: f64| start < t && t < length;
        match &self.form {
            ObstacleForm::Rectangle { frame, size } => {
                on_rectangle(frame, *size, ray).is_some_and(is_between)
            }
            ObstacleForm::Patch(patch) => ray.hits(patch).any(is_between),
            ObstacleForm::Mesh { triangles, shift } => {
                let point = ray.point - *shift;
                triangles.stop(&LegRay { point, ..*ray }, length, &is_between)
            }
        }
    }
}

impl ObstacleForm {
    /// The form of triangles, of which there is at least one.
    #[must_use]
    pub fn mesh(triangles: Vec<[DVec3; 3]>) -> Self {
        Self::Mesh {
            triangles: Arc::new(TriangleTree::new(triangles)),
            shift: DVec3::ZERO,
        }
    }

    /// The number of sizes: two for a rectangle, one for a patch, none for a mesh.
    pub(crate) fn sizes(&self) -> usize {
        match self {
            Self::Rectangle { .. } => 2,
            Self::Patch(_) => 1,
            Self::Mesh { .. } => 0,
        }
    }

    /// Changes the side along an axis, or the aperture.
    pub(crate) fn resize(&mut self, axis: usize, new: New<'_>) -> Option<()> {
        let size = match self {
            Self::Rectangle { size, .. } => size.get_mut(axis)?,
            Self::Patch(patch) => &mut patch.aperture,
            Self::Mesh { .. } => return None,
        };
        *size = new(*size);
        Some(())
    }

    /// Changes the position of the centre along an axis.
    pub(crate) fn reposition(&mut self, axis: usize, new: New<'_>) {
        let (origin, moved) = match self {
            Self::Rectangle { frame, .. } | Self::Patch(Patch { frame, .. }) => {
                (DVec3::ZERO, &mut frame.origin[axis])
            }
            Self::Mesh { triangles, shift } => (triangles.sphere.center, &mut shift[axis]),
        };
        *moved = new(origin[axis] + *moved) - origin[axis];
    }
}

/// A sphere that contains a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BoundingSphere {
    center: DVec3,
    radius: f64,
}

impl BoundingSphere {
    /// A sphere about points, of which there is at least one.
    pub(crate) fn new(points: &[DVec3]) -> Self {
        let [low, high] = enclosing(points);
        let center = 0.5 * (low + high);
        let radius = points.iter().map(|point| point.distance(center));
        Self {
            center,
            radius: (1.0 + ROUNDING) * radius.fold(0.0, f64::max),
        }
    }

    /// Checks whether a ray may meet the sphere within the first `length` metres.
    pub(crate) fn is_near(&self, ray: &LegRay, length: f64) -> bool {
        let away = self.center - ray.point;
        let beside = away.cross(ray.direction).length_squared();
        let along = away.dot(ray.direction);
        beside <= self.radius * self.radius
            && -self.radius <= along
            && along <= length + self.radius
    }
}

/// The triangles of a mesh in a sphere, and parts of the mesh with spheres of their own.
#[derive(Clone, Debug, PartialEq)]
pub struct TriangleTree {
    sphere: BoundingSphere,
    triangles: Vec<[DVec3; 3]>,
    parts: Vec<Self>,
}

/// The largest number of triangles that are not divided among parts.
const UNDIVIDED: usize = 8;

impl TriangleTree {
    /// Builds the tree of triangles, of which there is at least one.
    #[must_use]
    pub fn new(mut triangles: Vec<[DVec3; 3]>) -> Self {
        let corners = triangles.as_flattened();
        let sphere = BoundingSphere::new(corners);
        let mut parts = Vec::new();
        if triangles.len() > UNDIVIDED {
            let [low, high] = enclosing(corners);
            let axis = (high - low).max_position();
            let place = |[a, b, c]: &[DVec3; 3]| (*a + *b + *c)[axis];
            triangles.sort_by(|one, other| place(one).total_cmp(&place(other)));
            let rest = triangles.split_off(triangles.len() / 2);
            parts = [std::mem::take(&mut triangles), rest].map(Self::new).into();
        }
        Self {
            sphere,
            triangles,
            parts,
        }
    }

    /// Checks whether a ray meets a triangle at a distance that `is_between` accepts.
    fn stop(&self, ray: &LegRay, length: f64, is_between: &impl Fn(f64) -> bool) -> bool {
        if !self.sphere.is_near(ray, length) {
            return false;
        }
        let mut hits = self
            .triangles
            .iter()
            .filter_map(|triangle| on(triangle, ray));
        hits.any(is_between)
            || self
                .parts
                .iter()
                .any(|part| part.stop(ray, length, is_between))
    }
}

fn on_rectangle(frame: &Frame, size: [f64; 2], ray: &LegRay) -> Option<f64> {
    let point = frame.to_local(ray.point);
    let direction = frame.vector_to_local(ray.direction);
    let t = -point.z / direction.z;
    let at = point + t * direction;
    let is_inside = 2.0 * at.x.abs() <= size[0] && 2.0 * at.y.abs() <= size[1];
    is_inside.then_some(t)
}

/// The distance along a ray to a triangle. The ray meets the triangle if the three volumes
/// that the ray spans with the edges have the same sign (Plücker coordinates).
fn on([a, b, c]: &[DVec3; 3], ray: &LegRay) -> Option<f64> {
    let [p, q, r] = [*a, *b, *c].map(|corner| corner - ray.point);
    let volumes = [p.cross(q), q.cross(r), r.cross(p)].map(|face| face.dot(ray.direction));
    let one_sign = volumes.iter().all(|v| *v >= 0.0) || volumes.iter().all(|v| *v <= 0.0);
    let normal = (q - p).cross(r - p);
    let t = p.dot(normal) / ray.direction.dot(normal);
    (one_sign && t.is_finite()).then_some(t)
}

#[cfg(test)]
mod tests {
    use super::*;

    const RAY: LegRay = LegRay {
        point: DVec3::new(0.1, 0.2, 1.0),
        direction: DVec3::NEG_Z,
    };

    fn stops(form: &ObstacleForm, leg: usize, ray: &LegRay, length: f64) -> bool {
        let obstacle = Obstacle {
            name: String::new(),
            form: form.clone(),
            until: Some(3),
        };
        obstacle.stops(leg, ray, length)
    }

    /// Tests which rays are stopped by a square, by a bowl with its vertex on the square, and by
    /// two triangles that cover the square.
    #[test]
    fn what_is_in_the_way_stops_rays() {
        let frame = Frame::new(DVec3::new(0.0, 0.0, 0.5), DVec3::Z, DVec3::X).unwrap();
        let bowl = |curvature| Patch {
            frame,
            curvature: [curvature; 3],
            aperture: 0.3,
        };
        let corner = |x, y| DVec3::new(x, y, 0.5);
        let square = vec![
            [corner(-0.3, -0.3), corner(0.3, -0.3), corner(0.3, 0.3)],
            [corner(-0.3, -0.3), corner(0.3, 0.3), corner(-0.3, 0.3)],
        ];
        let size = [0.6, 0.6];
        let forms = [
            ObstacleForm::Rectangle { frame, size },
            ObstacleForm::Patch(bowl(0.0)),
            ObstacleForm::Patch(bowl(-0.1)),
            ObstacleForm::mesh(square),
        ];
        let beside = LegRay {
            point: RAY.point + 0.3 * DVec3::X,
            ..RAY
        };
        for form in forms {
            assert!(stops(&form, 0, &RAY, 0.6), "{form:?}");
            assert!(!stops(&form, 0, &RAY, 0.4), "{form:?}");
            assert!(
                stops(&form, 2, &RAY, 0.6) && !stops(&form, 3, &RAY, 0.6),
                "{form:?}"
            );
            assert!(!stops(&form, 0, &beside, 0.6), "{form:?}");
        }
    }
}
