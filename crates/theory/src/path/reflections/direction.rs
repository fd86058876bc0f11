//! Samples directions away from a scattering surface.
//!
//! Most directions are aimed at positions at the end of the leg. If the next surface is near, as in
//! a corner, the solid angle per unit area of this surface is unbounded. If all directions were
//! aimed at positions, the weights of paths would be unbounded too. Therefore some directions are
//! sampled by the angles of the lobe, independently of the next surface. This bounds the weights of
//! all paths.

use super::aim::DirectionCoordinates;
use super::guide::{Conditional, Gaussian, GuideMixture, HeavyTailedGaussian};
use crate::geometry::AffineMap;
use crate::obstacle::LegRay;
use crate::path::PathSurface;
use crate::path::ScatteringSurface;
use crate::path::local;
use glam::DVec3;

/// The share of directions that are sampled by the angles of the lobe, if the other directions are
/// aimed at positions.
const BY_LOBE: f64 = 0.25;

/// The directions away from a point of a scattering surface.
pub(super) struct OutgoingDirections<'a> {
    pub(super) aim: &'a DirectionCoordinates,
    /// The map of the chain to the end of the leg.
    pub(super) map: &'a AffineMap<4>,
    pub(super) scatterer: &'a ScatteringSurface,
    /// The surface at the end of the leg, if there is one.
    pub(super) next: Option<&'a PathSurface>,
    pub(super) point: DVec3,
    /// The unit normal at the point, on the side from which light arrives.
    pub(super) normal: DVec3,
}

/// A sampled direction.
pub(super) struct SampledDirection {
    pub(super) direction: DVec3,
    /// Probability per steradian.
    pub(super) density: f64,
    /// The point of the next surface whose coordinates the density depends on; `None` if the
    /// coordinates are not a position on a surface.
    pub(super) target: Option<DVec3>,
}

impl OutgoingDirections<'_> {
    /// Samples a direction for a point of the unit square.
    ///
    /// `st` is the local position of the point. `guide` gives the angles that reach the window from
    /// this position. `lobe` gives the angles into which the surface scatters light, with the
    /// mirror direction if there is one.
    pub(super) fn draw(
        &self,
        [a, b]: [f64; 2],
        st: [f64; 2],
        guide: &Conditional,
        lobe: (Gaussian<2>, Option<DVec3>),
    ) -> Option<SampledDirection> {
        let targets = self.targets(st, guide, lobe)?;
        let angles = DirectionCoordinates::Angles;
        let is_aimed = !matches!(self.aim, DirectionCoordinates::Angles);
        let lobe = HeavyTailedGaussian::new(&lobe.0).filter(|_| is_aimed);
        let by_lobe = if lobe.is_some() { BY_LOBE } else { 0.0 };
        let local = Some((self.scatterer, self.normal));
        let (direction, end, steradians) = match &lobe {
            Some(lobe) if a < by_lobe => {
                let at = lobe.draw([a / by_lobe, b]);
                let (direction, _) = angles.direction(self.point, at, local)?;
                let end = self.end(direction)?;
                let (_, steradians) = self.aim.direction(self.point, end, local)?;
                (direction, end, steradians)
            }
            _ => {
                let at = targets.draw([(a - by_lobe) / (1.0 - by_lobe), b]);
                let (direction, steradians) = self.aim.direction(self.point, at, local)?;
                (direction, at, steradians)
            }
        };
        // Either density may have drawn the direction, so it is weighted by both.
        let mut density = (1.0 - by_lobe) * targets.density(end) / steradians;
        if let Some(lobe) = lobe {
            let at = self.angles(direction);
            let (_, steradians) = angles.direction(self.point, at, local)?;
            density += by_lobe * lobe.density(at) / steradians;
        }
        Some(SampledDirection {
            direction,
            density,
            target: self.aim.target(end),
        })
    }

    /// The density of directions in the coordinates by which they are aimed.
    fn targets(
        &self,
        st: [f64; 2],
        guide: &Conditional,
        (lobe, mirrored): (Gaussian<2>, Option<DVec3>),
    ) -> Option<GuideMixture> {
        let seen = |angles: &Gaussian<2>| self.aim.seen(angles, st, self.map);
        let mut lobe = seen(&lobe);
        if let Some(mirrored) = mirrored {
            lobe.mean = self.aim.end(self.point, mirrored).unwrap_or(lobe.mean);
        }
        let guide = seen(&guide.at(st));
        let both = guide.product(&lobe);
        GuideMixture::new([(0.5, both), (0.25, Some(guide)), (0.25, Some(lobe))])
    }

    /// The longitude and latitude of a direction relative to the central ray.
    fn angles(&self, direction: DVec3) -> [f64; 2] {
        let ScatteringSurface {
            frame, outgoing, ..
        } = self.scatterer;
        let [.., longitude, latitude] = local(frame, self.point, self.normal, direction);
        [longitude - outgoing[0], latitude - outgoing[1]]
    }

    /// The point where a ray along a direction ends the leg, in the coordinates of the aim.
    /// Returns `None` if the ray misses the end of the leg.
    fn end(&self, direction: DVec3) -> Option<[f64; 2]> {
        let DirectionCoordinates::Patch { patch, .. } = self.aim else {
            return self.aim.end(self.point, direction);
        };
        let ray = LegRay {
            point: self.point,
            direction,
        };
        let at = patch.frame.to_local(self.next?.met(&ray)?);
        Some([at.x, at.y])
    }
}
