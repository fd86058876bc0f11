//! Which way light goes on a leg.

use crate::obstacles::ray_through;
use crate::reach::outline;
use crate::station::Station;
use etendue_field::{Frame, TwoPlane};
use etendue_scene::{Leg, Scene};
use glam::DVec3;

/// Which way light of a leg goes. Rays are held by slopes across the central ray, so each way has a frame of its own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Heading {
    /// Along the central ray.
    #[default]
    Along,
    /// Against it, from one wide surface back to another.
    Against,
}

impl Heading {
    /// A vector or a point between the frame of the leg and that of light which goes this way: turned about X.
    #[inline]
    pub(crate) fn turned(self, v: DVec3) -> DVec3 {
        match self {
            Self::Along => v,
            Self::Against => DVec3::new(v.x, -v.y, -v.z),
        }
    }

    /// The leg as light has it that goes this way.
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

    /// The way of a direction, and the ray through a point along it, in the frame of that way; both are given in the frame of the leg.
    /// `None` when it goes across the leg.
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

/// What a tracer has of a leg, for each way that light goes on it.
#[derive(Debug)]
pub(crate) struct Both<T> {
    pub(crate) along: T,
    /// `None` where no light goes that way.
    against: Option<Box<T>>,
}

impl<T> Both<T> {
    /// `make` is told the leg in the frame of each way.
    pub(crate) fn new(scene: &Scene, leg: usize, make: impl Fn(Heading, &Leg) -> T) -> Self {
        let this = &scene.path.legs[leg];
        let of = |heading: Heading| make(heading, &heading.leg(this));
        Self {
            along: of(Heading::Along),
            against: goes_back(scene, leg).then(|| Box::new(of(Heading::Against))),
        }
    }

    #[inline]
    pub(crate) fn of(&self, heading: Heading) -> Option<&T> {
        match heading {
            Heading::Along => Some(&self.along),
            Heading::Against => self.against.as_deref(),
        }
    }
}

/// Whether light may go back along a leg: to a part of the surface at its end that lies behind a part of the one at its beginning, or
/// where a plane on one of them looks. Light of the first leg goes forward.
fn goes_back(scene: &Scene, leg: usize) -> bool {
    let this = &scene.path.legs[leg];
    let Some(leaves) = &this.leaves else {
        return false;
    };
    let depths = |object| {
        let corners = outline(scene, object).into_iter();
        corners.map(|corner| this.frame.to_local(corner).z)
    };
    let begins = depths(leaves.object).fold(f64::NEG_INFINITY, f64::max);
    let ends = scene.path.ends_at(leg).map(|hit| depths(hit.object));
    let reaches_back = ends.is_some_and(|mut ends| ends.any(|end| end <= begins));
    let looks_back = scene.planes.iter().enumerate().any(|(index, plane)| {
        let station = Station::new(scene, index, plane);
        plane.leg == leg && station.view().is_some() && station.slopes(&plane.window).is_none()
    });
    reaches_back || looks_back
}
