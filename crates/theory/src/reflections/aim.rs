//! The two coordinates by which the rays of a leg are aimed. They parametrise directions away from
//! a point.
//!
//! If a leg runs straight to the next scattering surface, or to a plane across the leg, the
//! coordinates are a position on this surface or plane. Rays from all points of a wide surface can
//! then be aimed at a narrow window. Otherwise the coordinates are angles, and the landing point is
//! known only to first order.

use super::chain::{ScatteringSurface, towards};
use super::guide::Gaussian;
use super::{PathSurface, ReflectionSystem};
use crate::geometry::{AffineMap, Matrix, congruent, from_fn, times};
use crate::model::Observed;
use crate::rays::Plane;
use etendue_field::{Frame, Light, Orientation, Patch};
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

/// Rays from a surface may be aimed at a plane only if the plane's distance is at least this number
/// times the width of the surface. At such distances, no part of the surface lies beyond the plane.
const MIN_DISTANCE: f64 = 2.0;

impl DirectionCoordinates {
    /// Builds the coordinates of the leg with the given index; leg 0 begins at the light, and every
    /// other leg at a scatterer.
    pub(super) fn new(
        view: &Observed<ReflectionSystem>,
        scatterers: &[ScatteringSurface],
        leg: usize,
    ) -> Self {
        let Observed { system, plane } = view;
        let from = leg.checked_sub(1).map(|before| &scatterers[before]);
        let first = from.map_or(0, |from| from.number + 1);
        let to = scatterers.get(leg);
        match (from, to) {
            (None, _) if matches!(system.light, Light::Beam { .. }) => Self::Angles,
            (_, Some(to)) if to.number == first => {
                let patch = system.surfaces[first].patch;
                let local = patch.frame.to_local(to.frame.origin);
                let [t, b] = [to.frame.x, to.frame.y].map(|v| patch.frame.vector_to_local(v));
                Self::Patch {
                    patch,
                    hit: [local.x, local.y],
                    turn: [[t.x, b.x], [t.y, b.y]],
                }
            }
            (Some(from), None) if first == system.visited => {
                let surface = &system.surfaces[from.number];
                Self::at_plane(plane, surface)
            }
            _ => Self::Angles,
        }
    }

    fn at_plane(plane: &Plane, surface: &PathSurface) -> Self {
        let beyond = (plane.frame.origin - surface.hit).dot(plane.frame.d);
        let is_across = plane.orientation == Orientation::Orthogonal;
        if is_across && beyond > MIN_DISTANCE * surface.patch.aperture {
            Self::Plane(plane.frame)
        } else {
            Self::Angles
        }
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

    /// Returns the coordinates of the point where a ray ends the leg, if there is such a point.
    pub(super) fn end(&self, point: DVec3, direction: DVec3) -> Option<[f64; 2]> {
        let (frame, t) = match self {
            Self::Angles => return None,
            Self::Patch { patch, .. } => {
                let ray = crate::rays::LegRay { point, direction };
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

    /// Returns the point of the next surface with these coordinates.
    pub(super) fn target(&self, [a, b]: [f64; 2]) -> Option<DVec3> {
        match self {
            Self::Patch { patch, .. } => Some(patch.point(a, b)),
            Self::Angles | Self::Plane(_) => None,
        }
    }

    /// Returns the direction from a point that has these coordinates, and the solid angle in
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
