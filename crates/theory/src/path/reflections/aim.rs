//! The two coordinates by which the rays of a leg are aimed. They parametrise directions away from
//! a point.
//!
//! If a leg runs straight to the next scattering surface or to the plane, the coordinates can be a
//! position on this surface or plane. Rays from all points of a wide surface can then be aimed at a
//! narrow window. Otherwise the coordinates are angles, and the landing point is known only to
//! first order.

use super::guide::Gaussian;
use crate::geometry::{AffineMap, Matrix, congruent, from_fn, times};
use crate::path::{Observed, PathSystem};
use crate::path::{ScatteringSurface, towards};
use etendue_field::{EmittedRays, Frame, Orientation, Patch};
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

/// The coordinates that parametrise directions of a leg.
#[derive(Clone, Copy, Debug)]
pub(super) enum DirectionCoordinates {
    /// Longitude and latitude at the surface on which the leg begins, minus the longitude and
    /// latitude of the central ray.
    Angles,
    /// A position on the next scattering surface, along X and Y of its patch.
    Patch {
        patch: Patch,
        /// The position of the central ray's hit on the next surface.
        hit: [f64; 2],
        /// The rotation from the local coordinates at the central ray's hit to X and Y of the
        /// patch.
        turn: Matrix<2>,
    },
    /// A position on the plane.
    Plane(Frame),
}

impl DirectionCoordinates {
    /// Builds the coordinates of the leg with the given index; leg 0 begins at the light, and every
    /// other leg at a scatterer. Rays of the last leg are aimed by angles.
    pub(super) fn new(system: &PathSystem, scatterers: &[ScatteringSurface], leg: usize) -> Self {
        let from = leg.checked_sub(1).map(|before| &scatterers[before]);
        let first = from.map_or(0, |from| from.number + 1);
        let to = scatterers.get(leg);
        match (from, to) {
            (None, _) if matches!(system.light.rays(), EmittedRays::Parallel(_)) => Self::Angles,
            (_, Some(to)) if to.number == first => {
                Self::on_patch(system.surfaces[first].patch, &to.frame)
            }
            _ => Self::Angles,
        }
    }

    /// Positions on a patch. `frame` has the axes at the central ray's hit.
    fn on_patch(patch: Patch, frame: &Frame) -> Self {
        let local = patch.frame.to_local(frame.origin);
        let [t, b] = [frame.x, frame.y].map(|v| patch.frame.vector_to_local(v));
        Self::Patch {
            patch,
            hit: [local.x, local.y],
            turn: [[t.x, b.x], [t.y, b.y]],
        }
    }

    /// Positions on the plane or on its surface, for the leg from the last scatterer.
    /// Returns `None` if the leg does not run straight to the plane, or if the plane cuts the
    /// surface at which the leg begins.
    pub(super) fn at_plane(view: &Observed, scatterers: &[ScatteringSurface]) -> Option<Self> {
        let Observed { system, plane } = view;
        let from = scatterers.last()?.number;
        // A plane across the leg also counts light from parts of the surface beyond the plane. No
        // direction leads from these parts to the plane.
        let is_before = |p: &DVec3| (plane.frame.origin - p).dot(plane.frame.d) > 0.0;
        let is_beyond = match plane.orientation {
            Orientation::Orthogonal => system.surfaces[from].patch.corners().iter().all(is_before),
            _ => plane.is_arriving(),
        };
        (is_beyond && from + 1 == system.visited).then(|| match plane.patch {
            Some(patch) if plane.orientation.is_local() => Self::on_patch(patch, &plane.frame),
            _ => Self::Plane(plane.frame),
        })
    }

    /// Converts a Gaussian of angles at a point of the surface to these coordinates. `map` is the
    /// map to the end of the leg.
    pub(super) fn seen(
        &self,
        angles: &Gaussian<2>,
        [s, t]: [f64; 2],
        map: &AffineMap<4>,
    ) -> Gaussian<2> {
        if matches!(self, Self::Angles) {
            return *angles;
        }
        let per_angle: Matrix<2> = from_fn(|i, j| map.matrix[i][2 + j]);
        let [theta, phi] = angles.mean;
        let [x, y, ..] = map.apply([s, t, theta, phi]);
        self.counted(&Gaussian {
            mean: [x, y],
            covariance: congruent(&per_angle, &angles.covariance),
        })
    }

    /// Converts a Gaussian of the positions at the end of the leg to these coordinates.
    pub(super) fn counted(&self, positions: &Gaussian<2>) -> Gaussian<2> {
        match self {
            Self::Angles | Self::Plane(_) => *positions,
            Self::Patch { hit, turn, .. } => {
                let [x, y] = times(turn, &positions.mean);
                Gaussian {
                    mean: [hit[0] + x, hit[1] + y],
                    covariance: congruent(turn, &positions.covariance),
                }
            }
        }
    }

    /// The coordinates of the point where a ray ends the leg, if there is such a point.
    pub(super) fn end(&self, point: DVec3, direction: DVec3) -> Option<[f64; 2]> {
        let (frame, t) = match self {
            Self::Angles => return None,
            Self::Patch { patch, .. } => {
                let ray = crate::obstacle::LegRay { point, direction };
                (&patch.frame, ray.met(patch)?.0)
            }
            Self::Plane(frame) => {
                let t = (frame.origin - point).dot(frame.d) / direction.dot(frame.d);
                (frame, t)
            }
        };
        let at = frame.to_local(point + t * direction);
        (t > 0.0 && t.is_finite()).then_some([at.x, at.y])
    }

    /// The point of the next surface with these coordinates.
    pub(super) fn target(&self, [a, b]: [f64; 2]) -> Option<DVec3> {
        match self {
            Self::Patch { patch, .. } => Some(patch.point(a, b)),
            Self::Angles | Self::Plane(_) => None,
        }
    }

    /// The direction from a point that has these coordinates, and the solid angle in
    /// steradians per unit of the coordinates. `local` contains the normal about which angles are
    /// measured and the axes of the scatterer.
    pub(super) fn direction(
        &self,
        point: DVec3,
        [a, b]: [f64; 2],
        local: Option<(&ScatteringSurface, DVec3)>,
    ) -> Option<(DVec3, f64)> {
        let (target, normal, area) = match self {
            Self::Angles => {
                let (scatterer, normal) = local?;
                let [theta, phi] = scatterer.outgoing;
                let angles = [theta + a, phi + b];
                let is_in_front = angles.iter().all(|angle| angle.abs() < FRAC_PI_2);
                // dω = cos φ dθ dφ.
                let steradians = libm::cos(angles[1]);
                let towards = || towards(&scatterer.frame, normal, angles);
                return is_in_front.then(|| (towards(), steradians));
            }
            Self::Patch { patch, .. } => {
                let target = patch.point(a, b);
                let normal = patch.normal(target);
                (target, normal, 1.0 / normal.dot(patch.frame.d).abs())
            }
            Self::Plane(frame) => (frame.to_world(DVec3::new(a, b, 0.0)), frame.d, 1.0),
        };
        let away = target - point;
        let direction = away.try_normalize()?;
        let steradians = area * normal.dot(direction).abs() / away.length_squared();
        (steradians > 0.0 && steradians.is_finite()).then_some((direction, steradians))
    }
}
