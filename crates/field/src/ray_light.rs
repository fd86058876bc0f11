//! Light of finitely many rays, as ray files have it.

use crate::TwoPlane;
use serde::{Serialize, Serializer};

/// A ray that carries flux.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FluxRay {
    /// Where it crosses the plane of the light, and how.
    pub ray: TwoPlane,
    /// What it carries, W.
    pub flux: f64,
}

/// Rays through the plane of the light, all of which go forward. Before that plane and behind it they go straight on: a ray of a file that
/// begins beyond the plane is one that has come through it.
///
/// Its light field is a sum of deltas. A ray of flux Φ adds Φ (1 + u² + v²)² to radiance space.
#[derive(Clone, Debug, PartialEq)]
pub struct RayLight {
    rays: Vec<FluxRay>,
    /// The flux of all rays up to each and with it.
    upto: Vec<f64>,
    /// Flux of rays that do not go forward, W; they are left out.
    behind: f64,
    /// Lowest and highest coordinate along x and along y, m.
    extent: [[f64; 2]; 2],
    /// Largest slope along each.
    steepest: [f64; 2],
}

impl RayLight {
    /// Rays, and the flux of others that are left out. `None` where they carry nothing, or a number is not finite or a flux negative.
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

    /// Flux of rays that do not go forward, which are left out, W.
    #[must_use]
    pub fn behind(&self) -> f64 {
        self.behind
    }

    /// The ray at a share of the flux, from 0 to 1: each is found in proportion to its own.
    #[must_use]
    pub fn at_share(&self, share: f64) -> &FluxRay {
        let flux = share * self.flux();
        let index = self.upto.partition_point(|upto| *upto <= flux);
        // The last ray that carries any, should rounding lead beyond it.
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
    /// How many rays there are, and their flux.
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
