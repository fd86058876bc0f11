//! The two sides of a principled material.

use super::place::principled;
use super::turn::to_front;
use etendue_scatter::{Bsdf, BsdfSample, Principled, PrincipledInside};
use etendue_world::{self as world, TexturePoint};
use glam::DVec3;

/// A principled material at a point, as seen from one side.
pub(super) enum PrincipledSide {
    Front(Principled),
    Back(PrincipledInside),
}

impl PrincipledSide {
    /// Returns the side of `wo`.
    pub(super) fn new(of: &world::Principled, point: &TexturePoint, wo: DVec3) -> Self {
        let front = principled(of, point);
        if wo.z > 0.0 {
            Self::Front(front)
        } else {
            Self::Back(front.inside())
        }
    }

    fn bsdf(&self) -> &dyn Bsdf {
        match self {
            Self::Front(of) => of,
            Self::Back(of) => of,
        }
    }

    /// Returns the BSDF times |cos| of wi, and the density of [`Self::sample`] per solid angle.
    pub(super) fn value_and_density(&self, wi: DVec3, wo: DVec3) -> (f64, f64) {
        let turned = to_front(wo);
        let (value, density) = self.bsdf().value_and_density(turned(wi), turned(wo));
        (value * wi.z.abs(), density)
    }

    /// Samples a direction wi; `None` if light is absorbed.
    pub(super) fn sample(&self, wo: DVec3, random: [f64; 3]) -> Option<BsdfSample> {
        let turned = to_front(wo);
        let bounce = self.bsdf().sample(turned(wo), random)?;
        Some(BsdfSample {
            wi: turned(bounce.wi),
            ..bounce
        })
    }
}
