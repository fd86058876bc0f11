//! The geometric primitives that end rays.

use crate::grid::Grid;
use crate::line::{direction, start};
use crate::mesh::BlockerMesh;
use etendue_field::{Frame, Patch, Shape, TwoPlane, enclosing};
use glam::DVec3;

/// The geometry of an obstacle, in the frame of a leg. Large data are stored behind pointers,
/// because flat shapes are by far the most frequent obstacles and should stay in the processor's
/// cache.
#[derive(Clone, Debug)]
pub(crate) enum Primitive {
    /// A flat shape across the central ray.
    Flat { distance: f64, shape: Shape },
    /// Many flat shapes at one distance.
    Grid(Box<Grid>),
    /// A flat shape in the XY plane of a frame.
    Oblique { frame: Box<Frame>, shape: Shape },
    /// A mesh of triangles. A hit is identified by the number of the triangle.
    Mesh(Box<BlockerMesh>),
    /// A smooth surface.
    Smooth(Box<Patch>),
}

impl Primitive {
    /// The distance along the central ray at which a ray meets the primitive, and the
    /// number of the part (such as a triangle) that the ray meets. If there are several hits,
    /// returns the first hit beyond `from`. Hits of a mesh beyond `until` may be ignored.
    #[inline]
    pub(crate) fn closest_hit(
        &self,
        ray: &TwoPlane,
        from: f64,
        until: f64,
    ) -> Option<(f64, usize)> {
        if let Self::Flat { distance, shape } = self {
            let at = ray.travelled(*distance);
            return shape.contains(at.x, at.y).then_some((*distance, 0));
        }
        if let Self::Grid(grid) = self {
            let at = ray.travelled(grid.distance);
            return grid.contains(at.x, at.y).then_some((grid.distance, 0));
        }
        self.closest_hit_elsewhere(ray, from, until)
    }

    /// The same as [`Self::closest_hit`], for primitives that are not flat. Most primitives
    /// are flat, so this function is not inlined, and the machine code of loops over primitives
    /// stays small.
    #[inline(never)]
    fn closest_hit_elsewhere(&self, ray: &TwoPlane, from: f64, until: f64) -> Option<(f64, usize)> {
        let whole = |distance| (distance, 0);
        match self {
            Self::Flat { .. } | Self::Grid(_) => None,
            Self::Oblique { frame, shape } => {
                let (start, direction) = (start(ray), direction(ray));
                let distance = (frame.origin - start).dot(frame.d) / direction.dot(frame.d);
                let at = frame.to_local(start + distance * direction);
                (distance.is_finite() && shape.contains(at.x, at.y)).then_some(whole(distance))
            }
            Self::Mesh(mesh) => mesh.closest_hit(ray, from, until),
            Self::Smooth(patch) => {
                let hits = smooth_hits(patch, ray);
                hits.into_iter().find(|at| *at > from).map(whole)
            }
        }
    }

    /// The largest distance below `until` at which the line of a ray meets the primitive,
    /// and the number of the part that the line meets.
    pub(crate) fn last(&self, ray: &TwoPlane, until: f64) -> Option<(f64, usize)> {
        match self {
            Self::Mesh(mesh) => mesh.last(ray, until),
            Self::Smooth(patch) => {
                let hits = smooth_hits(patch, ray).into_iter().rev();
                hits.filter(|at| *at < until).map(|at| (at, 0)).next()
            }
            _ => {
                let met = self.closest_hit(ray, f64::NEG_INFINITY, until);
                met.filter(|(at, _)| *at < until)
            }
        }
    }

    /// Checks whether a ray meets the primitive at a distance between `from` and `until`. Only
    /// distances for which `does` returns true count.
    #[inline]
    pub(crate) fn is_occluded(
        &self,
        ray: &TwoPlane,
        [from, until]: [f64; 2],
        does: impl Fn(f64) -> bool,
    ) -> bool {
        if let Self::Mesh(mesh) = self {
            return mesh.is_occluded(ray, [from, until], does);
        }
        let first = self.closest_hit(ray, from, until);
        first.is_some_and(|(at, _)| does(at))
    }

    /// Calls `tell` with each distance at which the line of a ray meets the primitive, and with
    /// the number of the part at that hit.
    pub(crate) fn each(&self, ray: &TwoPlane, mut tell: impl FnMut(f64, usize)) {
        match self {
            Self::Mesh(mesh) => mesh.each(ray, tell),
            Self::Smooth(patch) => {
                // If a line touches the surface in a single hit, `tell` is called twice with the
                // same distance.
                let [first, last] = smooth_hits(patch, ray);
                let second = (last > first).then_some(last);
                let hits = [Some(first).filter(|at| !at.is_nan()), second];
                hits.into_iter().flatten().for_each(|at| tell(at, 0));
            }
            _ => {
                if let Some((at, part)) = self.closest_hit(ray, f64::NEG_INFINITY, f64::INFINITY) {
                    tell(at, part);
                }
            }
        }
    }

    /// The unit normal at a point of a part of the primitive.
    pub(crate) fn normal(&self, part: usize, point: DVec3) -> DVec3 {
        match self {
            Self::Flat { .. } | Self::Grid(_) => DVec3::Z,
            Self::Oblique { frame, .. } => frame.d,
            Self::Mesh(mesh) => mesh.normal(part, point),
            Self::Smooth(patch) => patch.normal(point),
        }
    }

    /// The normal of the plane of a part, if it is a triangle and may have another normal
    /// at its points.
    pub(crate) fn facet_normal(&self, part: usize) -> Option<DVec3> {
        match self {
            Self::Mesh(mesh) => Some(mesh.facet_normal(part)),
            _ => None,
        }
    }

    /// The lowest and the highest corner of the primitive's bounding box.
    pub(crate) fn bounds(&self) -> [DVec3; 2] {
        match self {
            Self::Flat { distance, shape } => {
                let bounds = shape.bounds();
                let [x, y] = [bounds.extent(0), bounds.extent(1)];
                [0, 1].map(|i| DVec3::new(x[i], y[i], *distance))
            }
            Self::Grid(grid) => {
                let [x, y] = grid.bounds;
                [0, 1].map(|i| DVec3::new(x[i], y[i], grid.distance))
            }
            Self::Oblique { frame, shape } => {
                let bounds = shape.bounds();
                let [[left, right], [low, high]] = [bounds.extent(0), bounds.extent(1)];
                let corners = [[left, low], [right, low], [left, high], [right, high]]
                    .map(|[x, y]| frame.to_world(DVec3::new(x, y, 0.0)));
                enclosing(&corners)
            }
            Self::Mesh(mesh) => mesh.bounds(),
            Self::Smooth(patch) => enclosing(&patch.corners()),
        }
    }
}

fn smooth_hits(patch: &Patch, ray: &TwoPlane) -> [f64; 2] {
    let frame = &patch.frame;
    patch.hits(
        frame.to_local(start(ray)),
        frame.vector_to_local(direction(ray)),
    )
}
