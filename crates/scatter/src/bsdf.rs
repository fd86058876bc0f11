//! What every BSDF answers, and the directions that paths go on to.

use glam::DVec3;

/// A BSDF at one place. wo is before the surface.
pub trait Bsdf {
    /// The BSDF, sr⁻¹, without what goes only one way.
    fn value(&self, wi: DVec3, wo: DVec3) -> f64;

    /// The density of [`Self::direction`] per solid angle of wi.
    fn density(&self, wi: DVec3, wo: DVec3) -> f64;

    /// A direction wi; `None` where light is absorbed or goes only one way.
    fn direction(&self, wo: DVec3, random: [f64; 3]) -> Option<DVec3>;

    /// The only direction possible for the last of three numbers; `None` where there are others.
    #[inline]
    fn mirrored(&self, _wo: DVec3, _random: f64) -> Option<BsdfSample> {
        None
    }

    /// A direction with its weight; `None` where light is absorbed.
    #[inline]
    fn sample(&self, wo: DVec3, random: [f64; 3]) -> Option<BsdfSample> {
        if let Some(only) = self.mirrored(wo, random[2]) {
            return Some(only);
        }
        let wi = self.direction(wo, random)?;
        let density = self.density(wi, wo);
        (density > 0.0).then(|| BsdfSample {
            wi,
            weight: self.value(wi, wo) * wi.z.abs() / density,
            density: Some(density),
        })
    }
}

/// A direction that a path goes on to.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// Where light comes from.
    pub wi: DVec3,
    /// BSDF times |cos| of wi over its density.
    pub weight: f64,
    /// Density per solid angle; `None` where only this direction was possible.
    pub density: Option<f64>,
}

impl BsdfSample {
    /// The only direction possible, with its weight.
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

/// A direction where it is before the surface.
#[inline]
pub(crate) fn before(direction: DVec3) -> Option<DVec3> {
    (direction.z > 0.0).then_some(direction)
}

/// A direction mirrored at a normal.
#[inline]
pub(crate) fn mirrored(direction: DVec3, normal: DVec3) -> DVec3 {
    2.0 * direction.dot(normal) * normal - direction
}
