//! Virtual planes, as rays of a leg cross them.

use crate::heading::Heading;
use crate::line::{direction, ray_through, start};
use etendue_field::{Frame, Orientation, Patch, Side, TwoPlane, VirtualPlane, Window};
use etendue_scene::{Leg, Object, Scene};
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

/// Where a plane stands on its leg, and how it looks at rays of the leg.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlaneOnLeg {
    pub(crate) plane: usize,
    /// Along the leg.
    pub(crate) distance: f64,
    /// Of the light that it looks at.
    heading: Heading,
    pub(crate) side: Side,
    /// `None` across the leg.
    surface: Option<SurfaceCoordinates>,
}

/// How a plane on a surface looks at it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfaceCoordinates {
    /// (T, B, N) at the central hit, in the frame of the leg.
    frame: Frame,
    longitude: f64,
    /// Directions are turned around: light arrives.
    arriving: bool,
    /// And about the normal.
    mirrored: bool,
    /// The surface itself, in the frame of the leg, where rays are counted from its local normals.
    patch: Option<Patch>,
}

/// Angles of a window at which its slopes are looked up, along each side.
const SIDE: u32 = 9;
/// Between these, slopes may be larger by less than this.
const MARGIN: f64 = 1.1;
/// Light that comes at larger angles to the central ray, in radians, is not aimed by its slopes.
const MAX_AIMED_ANGLE: f64 = 0.8;

/// The points of a line on a patch.
fn points(patch: &Patch, start: DVec3, along: DVec3) -> impl Iterator<Item = DVec3> {
    let hits = patch.hits(
        patch.frame.to_local(start),
        patch.frame.vector_to_local(along),
    );
    let met = hits.into_iter().filter(|t| !t.is_nan());
    met.map(move |t| start + t * along)
}

impl PlaneOnLeg {
    /// The ray of the leg, where it begins, that the plane has as `seen`, and dA over dx dy there; `None` if there is none.
    ///
    /// On a surface itself, light is counted per area of it (docs/theory.md, section 8); everywhere else dA is dx dy.
    pub(crate) fn leg_ray(&self, seen: &TwoPlane) -> Option<(TwoPlane, f64)> {
        match &self.surface {
            None => Some((seen.travelled(-self.distance), 1.0)),
            Some(surface) => surface.leg_ray(seen),
        }
    }

    /// A point of the plane by its coordinates, in the frame of the leg, with the normal there and dA over
    /// dx dy; `None` where the surface has none.
    pub(crate) fn point(&self, at: [f64; 2]) -> Option<(DVec3, DVec3, f64)> {
        let Some(view) = &self.surface else {
            return Some((DVec3::new(at[0], at[1], self.distance), DVec3::Z, 1.0));
        };
        let (point, frame) = view.point(at)?;
        Some((point, frame.d, 1.0 / frame.d.dot(view.frame.d)))
    }

    /// Whether what it sees at a point, (x, y), lies ahead of where the first leg begins: a surface may
    /// reach back beside the light.
    pub(crate) fn is_ahead(&self, at: [f64; 2]) -> bool {
        let arrives = self.surface.is_some_and(|view| view.arriving);
        !arrives || self.point(at).is_some_and(|(point, ..)| point.z > 0.0)
    }

    /// How it looks at the surface it is on; `None` across the leg.
    pub(crate) fn view(&self) -> Option<SurfaceCoordinates> {
        self.surface
    }

    pub(crate) fn new(scene: &Scene, index: usize, plane: &VirtualPlane) -> Self {
        let leg = &scene.path.legs[plane.leg];
        Self::of(Heading::Along, leg, scene, index, plane)
    }

    /// As it looks at light that goes one way on its leg, which is given in the frame of that way.
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
        }
    }

    /// How far along its way light on a ray of the leg, from `from` on, comes to the plane; `None` if it does not.
    ///
    /// Light that goes back along the leg comes to a plane on a surface, and nowhere near the central hit.
    #[inline]
    pub(crate) fn crossing(&self, ray: &TwoPlane, from: f64) -> Option<f64> {
        if self.heading == Heading::Along {
            return Some(self.distance);
        }
        let (point, _) = self.surface.as_ref()?.met(start(ray), direction(ray))?;
        (self.side == Side::After || point.z > from).then_some(point.z)
    }

    /// The largest slopes in the leg, along x and y, of light that arrives on a surface in the window of a plane; `None` across
    /// the leg, and where they have no bound worth aiming at.
    pub(crate) fn slopes(&self, window: &Window) -> Option<[f64; 2]> {
        self.surface.as_ref()?.slopes(window)
    }

    /// cos θ dω over du dv at a ray as the plane has it.
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

    /// A ray of the leg as the plane has it, with what it adds there; `None` when it does not meet the surface.
    #[inline]
    pub(crate) fn at_plane(&self, ray: &TwoPlane, weight: f64) -> Option<(TwoPlane, f64)> {
        match &self.surface {
            None => Some((ray.travelled(self.distance), weight)),
            Some(surface) => surface.at_plane(ray, weight),
        }
    }
}

impl SurfaceCoordinates {
    /// The frame of the local normal at a point, on the side of the one at the central hit; `None` where the surface has
    /// turned by a right angle or more. So of two points over the same coordinates one is left: a line meets the surface from
    /// one side and then from the other.
    fn local(&self, patch: &Patch, point: DVec3) -> Option<Frame> {
        let side = patch.normal(self.frame.origin).dot(self.frame.d).signum();
        let normal = side * patch.normal(point);
        (normal.dot(self.frame.d) > 0.0).then(|| self.frame.turned_to(normal))
    }

    /// The point of the surface at (x, y), and the frame of its normal.
    fn point(&self, [x, y]: [f64; 2]) -> Option<(DVec3, Frame)> {
        let foot = self.frame.to_world(DVec3::new(x, y, 0.0));
        let Some(patch) = &self.patch else {
            return Some((foot, self.frame));
        };
        let mut over = points(patch, foot, self.frame.d);
        over.find_map(|point| Some((point, self.local(patch, point)?)))
    }

    /// Where a ray meets the surface from the side the plane looks at, and the frame of the normal there.
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

    /// The inverse of [`Self::at_plane`].
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

    /// The coordinates of a direction away from the surface, to be counted from this frame, and dω cos θ over du dv; `None` behind it.
    fn seen(&self, frame: &Frame, away: DVec3) -> Option<([f64; 2], f64)> {
        let turned = if self.mirrored { -1.0 } else { 1.0 };
        let DVec3 { x: t, y: b, z: n } = frame.vector_to_local(away.normalize());
        let (longitude, sine) = (turned * libm::atan2(t, n), turned * b);
        let latitude = libm::asin(sine);
        // The angle to the normal has the cosine cos θ cos φ = n, and the solid angle is cos φ dθ dφ.
        let measure = n * libm::cos(latitude);
        (n > 0.0).then_some(([longitude - self.longitude, latitude], measure))
    }

    /// The inverse of [`Self::seen`].
    fn away(&self, frame: &Frame, [u, v]: [f64; 2]) -> Option<DVec3> {
        let turned = if self.mirrored { -1.0 } else { 1.0 };
        let angles = [turned * (u + self.longitude), turned * v];
        let [(sin, cos), (up, across)] = angles.map(libm::sincos);
        // A turn further the same direction has no other coordinates.
        angles
            .iter()
            .all(|angle| angle.abs() < FRAC_PI_2)
            .then(|| frame.vector_to_world(DVec3::new(across * sin, up, across * cos)))
    }

    fn slopes(&self, window: &Window) -> Option<[f64; 2]> {
        let [x, y, u, v] = [window.x, window.y, window.u, window.v].map(|p| p.half_width());
        // The normals of the patch turn by less than this within the window.
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

    /// Whether it looks at light that arrives.
    pub(crate) fn is_arriving(&self) -> bool {
        self.arriving
    }

    /// What angles are counted from at a point of the surface.
    fn frame_at(&self, point: DVec3) -> Option<Frame> {
        match &self.patch {
            None => Some(self.frame),
            Some(patch) => self.local(patch, point),
        }
    }

    /// The direction of a ray that leaves a point of the surface and has these coordinates, (u, v).
    pub(crate) fn direction(&self, point: DVec3, seen: [f64; 2]) -> Option<DVec3> {
        self.away(&self.frame_at(point)?, seen)
    }

    /// The inverse of [`Self::direction`].
    pub(crate) fn angles(&self, point: DVec3, direction: DVec3) -> Option<[f64; 2]> {
        let (seen, _) = self.seen(&self.frame_at(point)?, direction)?;
        Some(seen)
    }
}
