//! Evaluates and samples the BRDFs of scenes, with the lobes of `etendue_scatter`: light comes
//! from the direction wi and goes to the direction wo.
//!
//! Directions are unit vectors away from the surface, in a frame with the normal along Z. The type
//! [`Brdf`] defines the lobes.

mod mixture;

use etendue_field::{AngleTable, Brdf, Lobe, MicrofacetDistribution};
use etendue_scatter::{Microfacets, Phong, lambertian, reflectance};
use glam::DVec3;
pub use mixture::sum;
pub(crate) use mixture::{densities, towards};

/// The BRDF, sr⁻¹.
#[inline]
#[must_use]
pub fn value(brdf: &Brdf, wi: DVec3, wo: DVec3) -> f64 {
    if wi.z <= 0.0 || wo.z <= 0.0 {
        return 0.0;
    }
    let (lobe, cosine) = match brdf.lobe {
        Lobe::Lambertian => (lambertian::VALUE, wi.z),
        Lobe::Phong { exponent } => (Phong { exponent }.value(wo, wi), wi.z),
        Lobe::Beckmann { roughness } => beckmann(roughness).value(wo, wi),
        Lobe::Ggx { roughness } => ggx(roughness).value(wo, wi),
    };
    brdf.albedo
        * lobe
        * reflectance(&brdf.fresnel, cosine)
        * factor(brdf.incoming.as_ref(), wi)
        * factor(brdf.outgoing.as_ref(), wo)
}

/// The value of an angular factor's table for a direction, or 1 if there is no table.
#[inline]
fn factor(table: Option<&AngleTable>, direction: DVec3) -> f64 {
    table.map_or(1.0, |table| table.value(direction.z))
}

/// Draws a direction wo for a direction wi in front of the surface, with two random numbers in (0,
/// 1). If wo lies below the surface, it carries no light.
///
/// Backward rays draw wi for a given wo by the same lobes, because the lobes are symmetric. The
/// albedo and the angular factors are applied as weights, and do not affect the density.
#[inline]
pub(crate) fn sample(brdf: &Brdf, wi: DVec3, random: [f64; 2]) -> DVec3 {
    match brdf.lobe {
        Lobe::Lambertian => lambertian::sample(random),
        Lobe::Phong { exponent } => Phong { exponent }.sample(wi, random),
        Lobe::Beckmann { roughness } => beckmann(roughness).sample_unmasked(wi, random),
        Lobe::Ggx { roughness } => ggx(roughness).sample(wi, random),
    }
}

/// The density of [`sample`] per solid angle over the whole sphere, which includes
/// directions below the surface.
#[inline]
pub(crate) fn density(brdf: &Brdf, wi: DVec3, wo: DVec3) -> f64 {
    match brdf.lobe {
        Lobe::Lambertian => lambertian::density(wo),
        Lobe::Phong { exponent } => Phong { exponent }.value(wo, wi),
        Lobe::Beckmann { roughness } => beckmann(roughness).unmasked_density(wo, wi),
        Lobe::Ggx { roughness } => ggx(roughness).density(wo, wi),
    }
}

#[inline]
fn beckmann(roughness: f64) -> Microfacets {
    Microfacets::isotropic(MicrofacetDistribution::Beckmann, roughness)
}

#[inline]
fn ggx(roughness: f64) -> Microfacets {
    Microfacets::isotropic(MicrofacetDistribution::Ggx, roughness)
}
