//! The central ray and its intersections with the surfaces.

use crate::geometry::{Matrix, Media};
use crate::obstacle::LegRay;
use crate::path::{PathSurface, PathSystem};
use etendue_field::{Frame, Patch, Specular};
use glam::DVec3;

/// If the sine of the angle of incidence is below this threshold, light is treated as arriving
/// along the normal, and any plane through the normal is a plane of incidence.
const NORMAL: f64 = 1e-9;

/// The incidence of the central ray on a surface (docs/theory.md, section 7).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Incidence {
    /// The normal on the side of the incident light.
    pub(crate) n: DVec3,
    pub(crate) t: DVec3,
    pub(crate) b: DVec3,
    pub(crate) theta0: f64,
    /// The angle by which the leg's frame is turned about D, between −π/2 and π/2. After this turn,
    /// X lies in the plane of incidence.
    pub(super) turn: f64,
}

impl Incidence {
    /// The incidence for the frame of the arriving leg; `normal` may be on either side of
    /// the surface.
    pub(crate) fn new(frame: &Frame, normal: DVec3) -> Self {
        let n = normal * -normal.dot(frame.d).signum();
        // In the turned frame, Y = B and N + c₀ D = sin θ₀ X.
        let across = n + frame.d * -n.dot(frame.d);
        let (x, theta0) = if across.length() < NORMAL {
            (frame.x, 0.0)
        } else {
            let [along, aside] = [across.dot(frame.x), across.dot(frame.y)];
            let ahead = along > 0.0 || (along.abs() < NORMAL && aside > 0.0);
            let sign = if ahead { 1.0 } else { -1.0 };
            let x = across.normalize() * sign;
            (x, sign * libm::atan2(across.length(), -n.dot(frame.d)))
        };
        let t = -x * libm::cos(theta0) - frame.d * libm::sin(theta0);
        Self {
            n,
            t,
            b: n.cross(t),
            theta0,
            turn: libm::atan2(x.dot(frame.y), x.dot(frame.x)),
        }
    }

    /// The shape operator of a patch at a point: the derivative of the normal along (T, B),
    /// per metre. The operator is positive for a surface that is convex on the side of N.
    pub(crate) fn shape(&self, patch: &Patch, point: DVec3) -> Matrix<2> {
        let gradient = patch.gradient(patch.frame.to_local(point));
        let side = patch.frame.vector_to_world(gradient).dot(self.n).signum();
        let curvature = DVec3::from(patch.curvature) * (side / gradient.length());
        let axes = [self.t, self.b].map(|axis| patch.frame.vector_to_local(axis));
        axes.map(|a| axes.map(|b| a.dot(curvature * b)))
    }
}

/// The central ray at an element.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CentralHit {
    /// The frame of the leg that arrives at the element, with its origin at the hit point.
    pub(crate) arriving: Frame,
    /// The frame of the leg that leaves the element.
    pub(crate) leaving: Frame,
    /// Length of the leg that arrives at the element, in metres.
    pub(super) distance: f64,
    pub(crate) incidence: Incidence,
}

impl PathSystem {
    /// The hits of the central ray. Returns `None` if the ray misses an element or does
    /// not continue from it.
    pub(crate) fn hits(&self) -> Option<Vec<CentralHit>> {
        let mut frame = Frame::IDENTITY;
        let mut hits = Vec::new();
        for element in self.before_plane() {
            let ray = LegRay {
                point: frame.origin,
                direction: frame.d,
            };
            let (distance, normal) = ray.met(&element.patch)?;
            let arriving = frame.travelled(distance);
            let after = element.follow(&ray)?;
            frame = element.leaving(&arriving, normal, after.direction);
            hits.push(CentralHit {
                arriving,
                leaving: frame,
                distance,
                incidence: Incidence::new(&arriving, normal),
            });
        }
        Some(hits)
    }
}

impl PathSurface {
    /// The frame of the next leg. At a mirror the frame is mirrored, (−X, Y, D); at other
    /// elements the frame is turned to the new direction by the smallest angle.
    fn leaving(&self, arriving: &Frame, normal: DVec3, direction: DVec3) -> Frame {
        if self.event() != Some(Specular::Mirror) {
            return arriving.turned_to(direction);
        }
        let mirrored = |v: DVec3| v - normal * (2.0 * v.dot(normal));
        let y = mirrored(arriving.y);
        Frame {
            x: -mirrored(arriving.x),
            y,
            d: direction,
            ..*arriving
        }
    }

    /// The refractive indices before and after a refraction, for light along the D of the
    /// incidence's frame.
    pub(super) fn media(&self, incidence: &Incidence) -> Option<Media> {
        let Some(Specular::Refraction { front, back }) = self.event() else {
            return None;
        };
        let from_front = self.patch.frame.d.dot(incidence.n) > 0.0;
        let (before, after) = if from_front {
            (front, back)
        } else {
            (back, front)
        };
        Some(Media { before, after })
    }
}
