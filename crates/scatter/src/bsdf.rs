//! Defines the interface of BSDFs, and the sampled directions of paths.

use glam::DVec3;

/// A BSDF at one point. wo is in front of the surface.
pub trait Bsdf {
    /// The BSDF, sr⁻¹, without delta components.
    fn value(&self, wi: DVec3, wo: DVec3) -> f64;

    /// The density of [`Self::direction`] per solid angle of wi.
    fn density(&self, wi: DVec3, wo: DVec3) -> f64;

    /// Returns [`Self::value`] and [`Self::density`]; after inlining, they share their common terms.
    #[inline]
    fn value_and_density(&self, wi: DVec3, wo: DVec3) -> (f64, f64) {
        (self.value(wi, wo), self.density(wi, wo))
    }

    /// Samples a direction wi; `None` if light is absorbed, or if a delta component was chosen.
    fn direction(&self, wo: DVec3, random: [f64; 3]) -> Option<DVec3>;

    /// The delta direction for the last of three random numbers; `None` if that number
    /// selects a non-delta component.
    #[inline]
    fn mirrored(&self, _wo: DVec3, _random: f64) -> Option<BsdfSample> {
        None
    }

    /// Samples a direction with its weight; `None` if light is absorbed.
    #[inline]
    fn sample(&self, wo: DVec3, random: [f64; 3]) -> Option<BsdfSample> {
        if let Some(only) = self.mirrored(wo, random[2]) {
            return Some(only);
        }
        let wi = self.direction(wo, random)?;
        let (value, density) = self.value_and_density(wi, wo);
        (density > 0.0).then(|| BsdfSample {
            wi,
            weight: value * wi.z.abs() / density,
            density: Some(density),
        })
    }
}

/// A sampled direction in which a path continues.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// The direction from which light comes.
    pub wi: DVec3,
    /// BSDF times |cos| of wi, divided by the density.
    pub weight: f64,
    /// Density per solid angle; `None` for a delta direction.
    pub density: Option<f64>,
}

impl BsdfSample {
    /// A delta direction with its weight.
    #[inline]
    #[must_use]
    pub fn only(wi: DVec3, weight: f64) -> Self {
        Self {
            wi,
            weight,
            density: None,
        }
    }
}

/// A direction if it is in front of the surface.
#[inline]
pub(crate) fn before(direction: DVec3) -> Option<DVec3> {
    (direction.z > 0.0).then_some(direction)
}

/// A direction mirrored at a normal.
#[inline]
pub(crate) fn mirrored(direction: DVec3, normal: DVec3) -> DVec3 {
    2.0 * direction.dot(normal) * normal - direction
}
