//! Occluders other than the masks of the first leg.

use crate::barrier::Barrier;
use etendue_field::{Frame, Mask, Patch};
use glam::DVec3;

/// A straight leg of a ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LegRay {
    /// The point at which the leg starts.
    pub(crate) point: DVec3,
    /// The direction of the leg, a unit vector.
    pub(crate) direction: DVec3,
}

/// An occluder, in the frame at the light; it stops every ray that meets it.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// The name of the obstacle, which messages use.
    pub name: String,
    /// The shape of the obstacle and its position.
    pub form: ObstacleForm,
    /// The obstacle stops light only before the leg with this index; `None` stands for all legs.
    pub until: Option<usize>,
}

/// The shape and position of an obstacle.
#[derive(Clone, Debug, PartialEq)]
pub enum ObstacleForm {
    /// A mask across the first leg of the path. This obstacle stops light on leg `from` and on all
    /// later legs. If `from` is not the first leg, the mask is also among the masks of the first
    /// leg.
    Mask {
        /// The index of the first leg on which this obstacle blocks light.
        from: usize,
        /// Distance of the mask's plane from the light, metres.
        distance: f64,
        /// The mask, as a function of x and y.
        mask: Mask,
    },
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
    /// Opaque triangles.
    Mesh(Vec<[DVec3; 3]>),
}

/// Obstacles prepared for many rays.
#[derive(Debug)]
pub(crate) struct PreparedObstacles<'a>(Vec<(Option<usize>, Ready<'a>)>);

#[derive(Debug)]
enum Ready<'a> {
    Mask(usize, Barrier<'a>),
    Rectangle(&'a Frame, [f64; 2]),
    Patch(&'a Patch),
    Mesh {
        /// Centre of the bounding sphere.
        center: DVec3,
        radius: f64,
        triangles: &'a [[DVec3; 3]],
    },
}

/// Maximum relative rounding error of a distance.
pub(crate) const ROUNDING: f64 = 1e-9;

impl<'a> PreparedObstacles<'a> {
    pub(crate) fn new(obstacles: &'a [Obstacle]) -> Self {
        let ready = |form: &'a ObstacleForm| match form {
            ObstacleForm::Mask {
                from,
                distance,
                mask,
            } => Ready::Mask(*from, Barrier::new(*distance, mask)),
            ObstacleForm::Rectangle { frame, size } => Ready::Rectangle(frame, *size),
            ObstacleForm::Patch(patch) => Ready::Patch(patch),
            ObstacleForm::Mesh(triangles) => around(triangles),
        };
        let each = obstacles
            .iter()
            .map(|obstacle| (obstacle.until, ready(&obstacle.form)));
        Self(each.collect())
    }

    /// Returns the fraction of a ray's radiance that passes the obstacles over the first `length`
    /// metres of the leg with index `leg`.
    pub(crate) fn passes(&self, leg: usize, ray: &LegRay, length: f64) -> f64 {
        let start = ROUNDING * ray.point.length();
        let is_between = |t: f64| start < t && t < length;
        let mut passes = 1.0;
        let is_there = |until: &Option<usize>| until.is_none_or(|until| leg < until);
        for (_, ready) in self.0.iter().filter(|(until, _)| is_there(until)) {
            passes *= match ready {
                Ready::Mask(from, barrier) if leg >= *from => {
                    let t = (barrier.distance - ray.point.z) / ray.direction.z;
                    let at = ray.point + t * ray.direction;
                    if is_between(t) {
                        barrier.transmittance(at.x, at.y)
                    } else {
                        1.0
                    }
                }
                Ready::Mask(..) => 1.0,
                Ready::Rectangle(frame, size) => {
                    let t = on_rectangle(frame, *size, ray);
                    let is_met = t.is_some_and(is_between);
                    if is_met { 0.0 } else { 1.0 }
                }
                Ready::Patch(patch) => {
                    let is_met = on_patch(patch, ray).into_iter().flatten().any(is_between);
                    if is_met { 0.0 } else { 1.0 }
                }
                Ready::Mesh {
                    center,
                    radius,
                    triangles,
                } => {
                    let mut meets = triangles.iter().filter_map(|triangle| on(triangle, ray));
                    let is_met = is_near(*center, *radius, ray) && meets.any(is_between);
                    if is_met { 0.0 } else { 1.0 }
                }
            };
            if passes == 0.0 {
                break;
            }
        }
        passes
    }
}

fn around(triangles: &[[DVec3; 3]]) -> Ready<'_> {
    let corners = || triangles.as_flattened().iter();
    let low = corners().fold(DVec3::INFINITY, |low, corner| low.min(*corner));
    let high = corners().fold(DVec3::NEG_INFINITY, |high, corner| high.max(*corner));
    let center = 0.5 * (low + high);
    let radius = corners().map(|corner| corner.distance(center));
    Ready::Mesh {
        center,
        radius: radius.fold(0.0, f64::max),
        triangles,
    }
}

fn is_near(center: DVec3, radius: f64, ray: &LegRay) -> bool {
    let beside = (center - ray.point).cross(ray.direction);
    beside.length_squared() <= radius * radius
}

fn on_rectangle(frame: &Frame, size: [f64; 2], ray: &LegRay) -> Option<f64> {
    let point = frame.to_local(ray.point);
    let direction = frame.vector_to_local(ray.direction);
    let t = -point.z / direction.z;
    let at = point + t * direction;
    let is_inside = 2.0 * at.x.abs() <= size[0] && 2.0 * at.y.abs() <= size[1];
    is_inside.then_some(t)
}

/// Returns the distances to both intersections of a ray with the patch's quadric, or `None` for an
/// intersection that is not on the patch.
pub(crate) fn on_patch(patch: &Patch, ray: &LegRay) -> [Option<f64>; 2] {
    let point = patch.frame.to_local(ray.point);
    let direction = patch.frame.vector_to_local(ray.direction);
    let curved = DVec3::from(patch.curvature) * direction;
    let (a, b) = (curved.dot(direction), curved.dot(point) + direction.z);
    let c = patch.value(point);
    // To avoid cancellation, the second root is computed as c divided by q, the numerator of the
    // first root.
    let root = (b * b - a * c).sqrt();
    let q = -(b + root.copysign(b));
    [q / a, c / q]
        .map(|t| Some(t).filter(|t| t.is_finite() && patch.contains(point + *t * direction)))
}

/// Returns the distance along a ray to a triangle. The ray meets the triangle if the three volumes
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
    use etendue_field::{Rectangle, Shape};

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
        PreparedObstacles::new(&[obstacle]).passes(leg, ray, length) < 0.5
    }

    #[test]
    fn a_mask_counts_on_its_legs() {
        let shapes = vec![Shape::Rectangle(Rectangle {
            center: [0.1, 0.2],
            size: [0.1, 0.1],
        })];
        let mask = Mask::Opaque {
            shapes,
            half_planes: vec![],
        };
        let from = |from| ObstacleForm::Mask {
            from,
            distance: 0.5,
            mask: mask.clone(),
        };
        assert!(stops(&from(1), 1, &RAY, 0.6) && !stops(&from(1), 0, &RAY, 0.6));
        assert!(stops(&from(0), 0, &RAY, 0.6) && !stops(&from(1), 1, &RAY, 0.4));
        assert!(stops(&from(0), 2, &RAY, 0.6) && !stops(&from(0), 3, &RAY, 0.6));
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
            ObstacleForm::Mesh(square),
        ];
        let beside = LegRay {
            point: RAY.point + 0.3 * DVec3::X,
            ..RAY
        };
        for form in forms {
            assert!(stops(&form, 0, &RAY, 0.6), "{form:?}");
            assert!(!stops(&form, 0, &RAY, 0.4), "{form:?}");
            assert!(!stops(&form, 0, &beside, 0.6), "{form:?}");
        }
    }
}
