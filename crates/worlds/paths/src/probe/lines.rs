//! Defines the legs of the central ray of a probe, and converts lines to the coordinates of planes.

use crate::space::{Hit, Ray, SceneGeometry};
use etendue_field::{Frame, TwoPlane};
use glam::DVec3;

/// A leg of the central ray.
#[derive(Clone, Debug)]
pub(super) struct SurfaceLeg {
    /// The frame at the end of the leg. This end is nearer to the camera. D is the direction of
    /// light.
    pub(super) frame: Frame,
    /// The shape at the end of the leg; `None` at the camera.
    pub(super) shape: Option<usize>,
    /// Half-width along x and y of the window at the end of the leg.
    pub(super) position: f64,
    /// A line may hit the shape at the end of the leg at most at this distance from the plane at
    /// this end.
    pub(super) reach: f64,
    /// Half-width of the windows in slope.
    pub(super) slope: f64,
}

impl SurfaceLeg {
    /// The largest distance between the central ray and a line of the window, at a given
    /// distance before the end of the leg.
    pub(super) fn wide(&self, distance: f64) -> f64 {
        self.position + self.slope * distance
    }

    /// The line with the coordinates `seen` in a plane of this leg. The line starts at the
    /// end of the leg, which is the camera or a surface, and runs back towards the light.
    pub(super) fn line(&self, geometry: &SceneGeometry, plane: &Frame, seen: &TwoPlane) -> Ray {
        let point = plane.to_world(DVec3::new(seen.x, seen.y, 0.0));
        let along = plane
            .vector_to_world(DVec3::new(seen.u, seen.v, 1.0))
            .normalize();
        self.through(geometry, point, along)
    }

    /// The line through a point along the direction of light.
    pub(super) fn through(&self, geometry: &SceneGeometry, point: DVec3, along: DVec3) -> Ray {
        let start = self.start(geometry, point, along);
        Ray {
            from: start.map_or_else(|| self.at_end(point, along), |hit| hit.position),
            along: -along,
        }
    }

    /// The point at which the line through a point meets the surface at the end of the leg.
    /// If there are several such points, returns the point nearest to the plane at the end.
    pub(super) fn start(
        &self,
        geometry: &SceneGeometry,
        point: DVec3,
        along: DVec3,
    ) -> Option<Hit> {
        let shape = self.shape?;
        let from = self.at_end(point, along);
        let meets =
            |along: DVec3, reach: f64| geometry.meets(shape, &Ray { from, along }, [0.0, reach]);
        let ahead = meets(along, self.reach);
        let nearest = ahead.as_ref().map_or(self.reach, |hit| hit.distance);
        meets(-along, nearest).or(ahead)
    }

    /// The point of a line in the plane at the end of the leg.
    fn at_end(&self, point: DVec3, along: DVec3) -> DVec3 {
        let end = &self.frame;
        let left = (end.origin - point).dot(end.d) / along.dot(end.d);
        point + left * along
    }
}

/// A line in the coordinates of a plane.
pub(super) fn seen_by(plane: &Frame, point: DVec3, along: DVec3) -> TwoPlane {
    let (from, way) = (plane.to_local(point), plane.vector_to_local(along));
    let (u, v) = (way.x / way.z, way.y / way.z);
    TwoPlane {
        x: from.x - from.z * u,
        y: from.y - from.z * v,
        u,
        v,
    }
}
