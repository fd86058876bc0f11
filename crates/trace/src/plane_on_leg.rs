//! Computes the points at which rays of a leg cross virtual planes, and the coordinates of the rays
//! there.

use crate::heading::Heading;
use crate::line::{direction, ray_through, start};
use etendue_field::{Frame, Orientation, Patch, Side, TwoPlane, VirtualPlane, Window};
use etendue_scene::{Leg, Object, Scene};
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

/// The position of a virtual plane on its leg. It converts rays of the leg to coordinates of the
/// plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlaneOnLeg {
    pub(crate) plane: usize,
    /// Distance of the plane along the leg.
    pub(crate) distance: f64,
    /// Heading of the light that the virtual plane sees.
    heading: Heading,
    pub(crate) side: Side,
    /// The coordinates of a plane on a surface; `None` for a plane across the leg.
    surface: Option<SurfaceCoordinates>,
    /// Whether the surface to which the virtual plane belongs has points off the plane.
    is_off_surface: bool,
}

/// The coordinates of rays at a virtual plane that lies on a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfaceCoordinates {
    /// The frame (T, B, N) where the central ray meets the surface, in the frame of the leg.
    frame: Frame,
    longitude: f64,
    /// Whether directions are reversed because the virtual plane sees arriving light.
    arriving: bool,
    /// Whether directions are also rotated about the normal.
    mirrored: bool,
    /// The curved surface, in the frame of the leg; present only if angles are measured from the
    /// surface's local normals.
    patch: Option<Patch>,
}

/// Slopes are evaluated at this number of angles along each side of a window.
const SIDE: u32 = 9;
/// The largest evaluated angle is multiplied by this factor, to cover directions between the
/// evaluated directions.
const MARGIN: f64 = 1.1;
/// The largest angle to the central ray, in radians. At larger angles, light is not aimed by its
/// slopes.
const MAX_AIMED_ANGLE: f64 = 0.8;

/// Checks whether a straight line may meet an object twice.
pub(crate) fn bends(scene: &Scene, object: Object) -> bool {
    match object {
        Object::Surface(_) => false,
        Object::Patch(i) => scene.patches[i].patch.curvature[..2] != [0.0; 2],
        Object::Mesh(_) => true,
    }
}

/// The points at which a line meets a patch.
fn points(patch: &Patch, start: DVec3, along: DVec3) -> impl Iterator<Item = DVec3> {
    let local = patch.frame.to_local(start);
    let direction = patch.frame.vector_to_local(along);
    // A ray that is nearly perpendicular to its leg starts far from the surface, and a quadratic
    // equation solved from that start would lose digits.
    let near = -local.dot(direction) / direction.length_squared();
    let hits = patch.hits(local + near * direction, direction);
    let met = hits.into_iter().filter(|t| !t.is_nan());
    met.map(move |t| start + (near + t) * along)
}

impl PlaneOnLeg {
    /// The ray that has the coordinates `seen` at the virtual plane, and dA / dx dy at the
    /// plane; `None` if there is no such ray. The ray is given in the plane at the beginning of the
    /// leg.
    ///
    /// If the virtual plane follows a curved surface, light is counted per area of the surface
    /// (docs/theory.md, section 8); otherwise dA is dx dy.
    pub(crate) fn leg_ray(&self, seen: &TwoPlane) -> Option<(TwoPlane, f64)> {
        match &self.surface {
            None => Some((seen.travelled(-self.distance), 1.0)),
            Some(surface) => surface.leg_ray(seen),
        }
    }

    /// Finds the point of the virtual plane with given coordinates. Returns this point, the normal
    /// and dA / dx dy, in the frame of the leg; `None` if the surface has no such point.
    pub(crate) fn point(&self, at: [f64; 2]) -> Option<(DVec3, DVec3, f64)> {
        let Some(view) = &self.surface else {
            return Some((DVec3::new(at[0], at[1], self.distance), DVec3::Z, 1.0));
        };
        let (point, frame) = view.point(at)?;
        Some((point, frame.d, 1.0 / frame.d.dot(view.frame.d)))
    }

    /// Checks whether the point (x, y) of the virtual plane lies beyond the beginning of the
    /// first leg. Part of a surface may extend back beside the light, before the beginning of the
    /// leg.
    pub(crate) fn is_ahead(&self, at: [f64; 2]) -> bool {
        let arrives = self.surface.is_some_and(|view| view.arriving);
        !arrives || self.point(at).is_some_and(|(point, ..)| point.z > 0.0)
    }

    /// Checks whether the virtual plane lies across the leg and sees light along the leg.
    pub(crate) fn is_across(&self) -> bool {
        self.surface.is_none() && self.heading == Heading::Along
    }

    /// The surface coordinates of the virtual plane; `None` for a plane across the leg.
    pub(crate) fn view(&self) -> Option<SurfaceCoordinates> {
        self.surface
    }

    pub(crate) fn new(scene: &Scene, index: usize, plane: &VirtualPlane) -> Self {
        let leg = &scene.path.legs[plane.leg];
        Self::of(Heading::Along, leg, scene, index, plane)
    }

    /// The position and coordinates of a virtual plane for light of one heading on the
    /// plane's leg, in the frame of that heading.
    pub(crate) fn of(
        heading: Heading,
        leg: &Leg,
        scene: &Scene,
        index: usize,
        plane: &VirtualPlane,
    ) -> Self {
        let path = &scene.path;
        let arriving = plane.side == Side::Before;
        let hit = if arriving {
            path.ends_at(plane.leg)
        } else {
            leg.leaves.as_ref()
        };
        let patch = match hit.map(|hit| hit.object) {
            Some(Object::Patch(i)) if plane.orientation.is_local() => {
                Some(scene.patches[i].patch.seen_from(&leg.frame))
            }
            _ => None,
        };
        let surface = (plane.orientation != Orientation::Orthogonal).then(|| SurfaceCoordinates {
            frame: leg.frame.decompose(&path.frame.decompose(&plane.frame)),
            longitude: plane.longitude,
            arriving,
            mirrored: plane.orientation == Orientation::Mirrored,
            patch,
        });
        Self {
            plane: index,
            distance: heading.turned(path.along(plane) * DVec3::Z).z,
            heading,
            side: plane.side,
            surface,
            is_off_surface: plane.orientation == Orientation::Tangent
                && hit.is_some_and(|hit| bends(scene, hit.object)),
        }
    }

    /// The distance, at least `from`, at which light on a ray of the leg reaches the
    /// virtual plane; `None` if the light does not reach the plane.
    ///
    /// A virtual plane on a surface records light at the point where the light meets the surface.
    /// An oblique surface extends before and behind its central hit, so an occluder may shade
    /// only a part of the surface. Light that travels back along the leg reaches only virtual
    /// planes that lie on a surface.
    #[inline]
    pub(crate) fn crossing(&self, ray: &TwoPlane, from: f64) -> Option<f64> {
        let Some(surface) = &self.surface else {
            return (self.heading == Heading::Along).then_some(self.distance);
        };
        let (point, _) = surface.met(start(ray), direction(ray))?;
        (self.side == Side::After || point.z > from).then_some(point.z)
    }

    /// The distance as [`Self::crossing`] does, for a photon that starts at the distance
    /// `from`. `arrival` is the distance at which the photon arrives at the surface at the end of
    /// the leg, or `None` if the photon meets another obstacle first. If a photon starts or ends
    /// on the surface of the virtual plane, the photon crosses the plane at its start or end. On a
    /// tangent plane of a curved surface, light counts as if the surface were absent.
    #[inline]
    pub(crate) fn crossing_of_photon(
        &self,
        ray: &TwoPlane,
        from: f64,
        arrival: Option<f64>,
    ) -> Option<f64> {
        let known = match self.side {
            Side::After => Some(from),
            Side::Before => arrival.filter(|_| !self.is_off_surface),
        };
        let known = known.filter(|_| self.surface.is_some());
        known.or_else(|| self.crossing(ray, from))
    }

    /// The largest slopes relative to the leg, along x and y, of light that arrives on a
    /// surface within the window of a virtual plane. Returns `None` for a plane across the leg,
    /// or if the slopes are too large for aiming.
    pub(crate) fn slopes(&self, window: &Window) -> Option<[f64; 2]> {
        self.surface.as_ref()?.slopes(window)
    }

    /// The ratio cos θ dω / du dv for a ray in the coordinates of the virtual plane.
    pub(crate) fn flux_per_radiance(&self, seen: &TwoPlane) -> f64 {
        match &self.surface {
            None => 1.0 / (seen.secant_squared() * seen.secant_squared()),
            Some(view) => {
                // As in `SurfaceCoordinates::seen`: cos θ is cos(u) cos(v), and dω is cos(v) du dv.
                let latitude = libm::cos(seen.v);
                libm::cos(seen.u + view.longitude) * latitude * latitude
            }
        }
    }

    /// A ray of the leg in the coordinates of the virtual plane, with its contribution at
    /// the plane; `None` if the ray does not meet the plane's surface.
    #[inline]
    pub(crate) fn at_plane(&self, ray: &TwoPlane, weight: f64) -> Option<(TwoPlane, f64)> {
        match &self.surface {
            None => Some((ray.travelled(self.distance), weight)),
            Some(surface) => surface.at_plane(ray, weight),
        }
    }
}

impl SurfaceCoordinates {
    /// The frame of the local normal at a point. The local normal points to the same side
    /// as the normal at the central hit. Returns `None` if the two normals differ by a right angle
    /// or more. A line may meet a curved surface once from each side, so only one of two points
    /// with the same coordinates has a frame of the local normal.
    fn local(&self, patch: &Patch, point: DVec3) -> Option<Frame> {
        let side = patch.normal(self.frame.origin).dot(self.frame.d).signum();
        let normal = side * patch.normal(point);
        (normal.dot(self.frame.d) > 0.0).then(|| self.frame.turned_to(normal))
    }

    /// The point of the surface at (x, y), and the frame of the normal at this point.
    fn point(&self, [x, y]: [f64; 2]) -> Option<(DVec3, Frame)> {
        let foot = self.frame.to_world(DVec3::new(x, y, 0.0));
        let Some(patch) = &self.patch else {
            return Some((foot, self.frame));
        };
        let mut over = points(patch, foot, self.frame.d);
        over.find_map(|point| Some((point, self.local(patch, point)?)))
    }

    /// The point where a ray meets the surface from the side that the virtual plane sees,
    /// and the frame of the normal at this point.
    fn met(&self, start: DVec3, along: DVec3) -> Option<(DVec3, Frame)> {
        let Some(patch) = &self.patch else {
            let t = (self.frame.origin - start).dot(self.frame.d) / along.dot(self.frame.d);
            return Some((start + t * along, self.frame));
        };
        let away = if self.arriving { -along } else { along };
        let frame = |point| {
            self.local(patch, point)
                .filter(|frame| frame.d.dot(away) > 0.0)
        };
        points(patch, start, along).find_map(|point| Some((point, frame(point)?)))
    }

    /// The ray with given coordinates at the plane, as the inverse of [`Self::at_plane`].
    fn leg_ray(&self, seen: &TwoPlane) -> Option<(TwoPlane, f64)> {
        let (point, frame) = self.point([seen.x, seen.y])?;
        let away = self.away(&frame, [seen.u, seen.v])?;
        let ray = ray_through(point, if self.arriving { -away } else { away })?;
        Some((ray, 1.0 / frame.d.dot(self.frame.d)))
    }

    fn at_plane(&self, ray: &TwoPlane, weight: f64) -> Option<(TwoPlane, f64)> {
        let along = direction(ray);
        let (point, frame) = self.met(start(ray), along)?;
        let away = if self.arriving { -along } else { along };
        let ([u, v], measure) = self.seen(&frame, away)?;
        let at = self.frame.to_local(point);
        let secant_squared = ray.secant_squared();
        let ray = TwoPlane {
            x: at.x,
            y: at.y,
            u,
            v,
        };
        Some((ray, weight / (secant_squared * secant_squared * measure)))
    }

    /// The coordinates of a direction away from the surface, measured in `frame`, and the
    /// ratio cos θ dω / du dv; `None` for a direction that points behind the surface.
    fn seen(&self, frame: &Frame, away: DVec3) -> Option<([f64; 2], f64)> {
        let turned = if self.mirrored { -1.0 } else { 1.0 };
        let DVec3 { x: t, y: b, z: n } = frame.vector_to_local(away.normalize());
        let (longitude, sine) = (turned * libm::atan2(t, n), turned * b);
        let latitude = libm::asin(sine);
        // The angle to the normal has the cosine cos θ cos φ = n, and the solid angle is cos φ dθ dφ.
        let measure = n * libm::cos(latitude);
        (n > 0.0).then_some(([longitude - self.longitude, latitude], measure))
    }

    /// The direction away from the surface with given angles, as the inverse of
    /// [`Self::seen`].
    fn away(&self, frame: &Frame, [u, v]: [f64; 2]) -> Option<DVec3> {
        let turned = if self.mirrored { -1.0 } else { 1.0 };
        let angles = [turned * (u + self.longitude), turned * v];
        let [(sin, cos), (up, across)] = angles.map(libm::sincos);
        // Larger angles would describe a direction that other coordinates already describe.
        angles
            .iter()
            .all(|angle| angle.abs() < FRAC_PI_2)
            .then(|| frame.vector_to_world(DVec3::new(across * sin, up, across * cos)))
    }

    fn slopes(&self, window: &Window) -> Option<[f64; 2]> {
        let [x, y, u, v] = [window.x, window.y, window.u, window.v].map(|p| p.half_width());
        // Within the window, the normals of the patch turn by at most this angle.
        let turns = self.patch.map_or(0.0, |patch| {
            patch.curvature.map(f64::abs).iter().sum::<f64>() * libm::hypot(x, y)
        });
        let mut widest = [0.0_f64; 2];
        for i in 0..SIDE * SIDE {
            let [s, t] =
                [i % SIDE, i / SIDE].map(|n| 2.0 * f64::from(n) / f64::from(SIDE - 1) - 1.0);
            let away = self.away(&self.frame, [s * u, t * v])?;
            let along = if self.arriving { -away } else { away };
            for (widest, across) in widest.iter_mut().zip([along.x, along.y]) {
                *widest = widest.max(libm::atan2(across, along.z).abs());
            }
        }
        let widest = widest.map(|angle| MARGIN * angle + 2.0 * turns);
        (widest[0].max(widest[1]) < MAX_AIMED_ANGLE).then(|| widest.map(libm::tan))
    }

    /// Checks whether the virtual plane sees arriving light.
    pub(crate) fn is_arriving(&self) -> bool {
        self.arriving
    }

    /// The frame in which angles are measured at a point of the surface.
    fn frame_at(&self, point: DVec3) -> Option<Frame> {
        match &self.patch {
            None => Some(self.frame),
            Some(patch) => self.local(patch, point),
        }
    }

    /// The direction of a ray that leaves a point of the surface with the angles (u, v).
    pub(crate) fn direction(&self, point: DVec3, seen: [f64; 2]) -> Option<DVec3> {
        self.away(&self.frame_at(point)?, seen)
    }

    /// The angles of a direction at a point, as the inverse of [`Self::direction`].
    pub(crate) fn angles(&self, point: DVec3, direction: DVec3) -> Option<[f64; 2]> {
        let (seen, _) = self.seen(&self.frame_at(point)?, direction)?;
        Some(seen)
    }
}
