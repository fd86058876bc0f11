//! Lights that are finite lists of rays, as in ray files.

use crate::TwoPlane;
use serde::{Serialize, Serializer};

/// A ray that carries flux.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FluxRay {
    /// The ray at the plane of the light.
    pub ray: TwoPlane,
    /// The flux of the ray, W.
    pub flux: f64,
}

/// Rays through the plane of the light. All rays go forward. The rays are straight lines on both
/// sides of the plane. If a ray of the file begins beyond the plane, it is extended back to the
/// plane.
///
/// The light field is a sum of deltas. A ray of flux Φ adds Φ (1 + u² + v²)² to radiance space.
#[derive(Clone, Debug, PartialEq)]
pub struct RayLight {
    rays: Vec<FluxRay>,
    /// For each ray, the sum of the fluxes of this ray and of all rays before it, in watts.
    upto: Vec<f64>,
    /// Flux of rays that do not go forward, W; these rays are left out.
    behind: f64,
    /// The lowest and highest coordinate along x and along y, m.
    extent: [[f64; 2]; 2],
    /// The largest slope of a ray along each axis.
    steepest: [f64; 2],
}

impl RayLight {
    /// Builds the light from rays, and from the flux of the rays that are left out. Returns `None`
    /// if the rays carry no flux, if a flux is negative, or if a number is not finite.
    #[must_use]
    pub fn new(rays: Vec<FluxRay>, behind: f64) -> Option<Self> {
        let mut flux = 0.0;
        let mut extent = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        let mut steepest = [0.0_f64; 2];
        let mut upto = Vec::with_capacity(rays.len());
        for FluxRay { ray, flux: own } in &rays {
            let TwoPlane { x, y, u, v } = *ray;
            let numbers = [x, y, u, v, *own];
            if numbers.iter().any(|number| !number.is_finite()) || *own < 0.0 {
                return None;
            }
            flux += own;
            upto.push(flux);
            for (axis, [at, slope]) in [[x, u], [y, v]].into_iter().enumerate() {
                let [low, high] = &mut extent[axis];
                (*low, *high) = (low.min(at), high.max(at));
                steepest[axis] = steepest[axis].max(slope.abs());
            }
        }
        let sound = flux > 0.0 && flux.is_finite();
        sound.then_some(Self {
            rays,
            upto,
            behind,
            extent,
            steepest,
        })
    }

    /// All rays, in the order of the file.
    #[must_use]
    pub fn rays(&self) -> &[FluxRay] {
        &self.rays
    }

    /// The flux of all rays, W.
    #[must_use]
    pub fn flux(&self) -> f64 {
        self.upto.last().copied().unwrap_or(0.0)
    }

    /// The flux of the omitted rays, which do not go forward, W.
    #[must_use]
    pub fn behind(&self) -> f64 {
        self.behind
    }

    /// The ray at a share of the cumulative flux, from 0 to 1. If the share is random, each
    /// ray is sampled in proportion to its flux.
    #[must_use]
    pub fn at_share(&self, share: f64) -> &FluxRay {
        let flux = share * self.flux();
        let index = self.upto.partition_point(|upto| *upto <= flux);
        // Because of rounding, the search can end after the last ray with non-zero flux; then this
        // last ray is used.
        let last = || self.upto.partition_point(|upto| *upto < self.flux());
        self.rays.get(index).unwrap_or_else(|| &self.rays[last()])
    }

    pub(crate) fn extent(&self, axis: usize) -> [f64; 2] {
        self.extent[axis]
    }

    pub(crate) fn steepest(&self, axis: usize) -> f64 {
        self.steepest[axis]
    }
}

impl Serialize for RayLight {
    /// Serialises the number of rays and their flux.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        (self.rays.len(), self.flux()).serialize(serializer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn light(fluxes: &[f64]) -> Option<RayLight> {
        let ray = |(i, flux): (usize, &f64)| FluxRay {
            ray: TwoPlane {
                x: i as f64,
                ..TwoPlane::default()
            },
            flux: *flux,
        };
        RayLight::new(fluxes.iter().enumerate().map(ray).collect(), 0.0)
    }

    #[test]
    fn rays_are_found_by_their_flux() {
        let light = light(&[0.0, 1.0, 0.0, 3.0, 0.0]).unwrap();
        let found = |share: f64| light.at_share(share).ray.x;
        let drawn = [0.0, 0.2, 0.25, 0.9, 1.0].map(found);
        assert_eq!(
            drawn.map(f64::to_bits),
            [1.0_f64, 1.0, 3.0, 3.0, 3.0].map(f64::to_bits)
        );
        assert_eq!(
            light.extent(0).map(f64::to_bits),
            [0.0_f64, 4.0].map(f64::to_bits)
        );
    }

    #[test]
    fn light_that_carries_nothing_is_none() {
        assert!(light(&[]).is_none());
        assert!(light(&[0.0]).is_none());
        assert!(light(&[1.0, -1.0]).is_none());
        assert!(light(&[f64::NAN]).is_none());
    }
}
