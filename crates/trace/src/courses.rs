//! The two directions in which light can travel along a leg, with a tracer's data for each
//! direction.

use crate::heading::Heading;
use crate::plane_on_leg::PlaneOnLeg;
use crate::reach::outline;
use etendue_scene::{Leg, Scene};

/// A tracer's data for a leg, for each direction in which light travels along it.
#[derive(Debug)]
pub(crate) struct Both<T> {
    pub(crate) along: T,
    /// Data for light that travels against the central ray; `None` if no light travels backwards
    /// along the leg.
    against: Option<Box<T>>,
}

impl<T> Both<T> {
    /// Calls `make` for each direction of light, with the leg in the frame of that direction.
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

/// Checks whether light may travel back along a leg. Light may travel back along a leg if part of
/// the surface at the leg's end lies behind part of the surface at the leg's beginning. Light may
/// also travel back if the window of a plane on one of these surfaces contains such light. Light of
/// the first leg always goes forward.
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
        let plane_on_leg = PlaneOnLeg::new(scene, index, plane);
        plane.leg == leg
            && plane_on_leg.view().is_some()
            && plane_on_leg.slopes(&plane.window).is_none()
    });
    reaches_back || looks_back
}

/// The distance from a leg's beginning within which hits are attributed to rounding
/// errors and ignored.
pub(crate) fn rounding(leg: &Leg) -> f64 {
    const SHARE: f64 = 1e-9;
    match leg.leaves {
        None => 0.0,
        Some(hit) => SHARE * (hit.point.length() + leg.start),
    }
}
