//! What a quadrature over a plane asks of a light field: as it is, or to first order.

use super::incoming::Rule as LightRule;
use super::linear::Linear;
use super::{System, exact, linear};
use crate::rays::Plane;

/// A light field over the coordinates of a plane.
pub(super) trait Field: Sync {
    /// Where a ray of the plane leaves the surface.
    type Leaving;
    type Shining;
    fn leaving(&self, z: [f64; 4]) -> Option<Self::Leaving>;
    /// What shines there.
    fn shines(&self, leaving: &Self::Leaving, rule: &LightRule) -> Vec<Self::Shining>;
    fn radiance(&self, leaving: &Self::Leaving, shines: &[Self::Shining]) -> f64;
    fn system(&self) -> &System;
}

/// As it is.
pub(super) struct Exact<'a>(pub(super) &'a System, pub(super) &'a Plane);

impl Field for Exact<'_> {
    type Leaving = exact::Leaving;
    type Shining = exact::Shining;
    fn leaving(&self, z: [f64; 4]) -> Option<Self::Leaving> {
        self.0.leaving(self.1, z)
    }
    fn shines(&self, leaving: &Self::Leaving, rule: &LightRule) -> Vec<Self::Shining> {
        self.0.shines(leaving, rule)
    }
    fn radiance(&self, leaving: &Self::Leaving, shines: &[Self::Shining]) -> f64 {
        let Self(system, plane) = self;
        let radiance = system.radiance(leaving, shines);
        if plane.orientation.is_local() {
            // On the surface itself the integral is over its area, which exceeds that of the tangent plane.
            radiance / leaving.normal.dot(plane.frame.d).abs()
        } else {
            radiance
        }
    }
    fn system(&self) -> &System {
        self.0
    }
}

impl Field for Linear<'_> {
    type Leaving = [f64; 4];
    type Shining = linear::Shining;
    fn leaving(&self, z: [f64; 4]) -> Option<[f64; 4]> {
        Some(self.local(z))
    }
    fn shines(&self, leaving: &[f64; 4], rule: &LightRule) -> Vec<Self::Shining> {
        Linear::shines(self, *leaving, rule)
    }
    fn radiance(&self, leaving: &[f64; 4], shines: &[Self::Shining]) -> f64 {
        Linear::radiance(self, *leaving, shines)
    }
    fn system(&self) -> &System {
        self.system
    }
}
