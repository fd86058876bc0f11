//! Defines the two directions of light along a leg, each with its own frame.

use crate::line::ray_through;
use etendue_field::{Frame, TwoPlane};
use etendue_scene::Leg;
use glam::DVec3;

/// The direction of light along a leg. Rays are represented by slopes relative to the central
/// ray, so each of the two directions of light needs its own frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Heading {
    /// Along the central ray.
    #[default]
    Along,
    /// Against the central ray: light from one extended surface back to another.
    Against,
}

impl Heading {
    /// Converts a vector or a point between the frame of the leg and the frame of this heading by
    /// a rotation about X.
    #[inline]
    pub(crate) fn turned(self, v: DVec3) -> DVec3 {
        match self {
            Self::Along => v,
            Self::Against => DVec3::new(v.x, -v.y, -v.z),
        }
    }

    /// The leg in the frame of light with this heading.
    pub(crate) fn leg(self, leg: &Leg) -> Leg {
        let axis = |local| leg.frame.vector_to_world(self.turned(local));
        Leg {
            frame: Frame {
                origin: leg.frame.origin,
                x: axis(DVec3::X),
                y: axis(DVec3::Y),
                d: axis(DVec3::Z),
            },
            ..*leg
        }
    }

    /// The heading of light that travels in a direction. Also returns the ray that passes
    /// through a point in this direction, in the frame of the heading. Both arguments are in the
    /// frame of the leg. Returns `None` if the direction is perpendicular to the leg.
    #[inline]
    pub(crate) fn of(point: DVec3, direction: DVec3) -> Option<(Self, TwoPlane)> {
        let heading = if direction.z < 0.0 {
            Self::Against
        } else {
            Self::Along
        };
        let ray = ray_through(heading.turned(point), heading.turned(direction))?;
        Some((heading, ray))
    }
}
